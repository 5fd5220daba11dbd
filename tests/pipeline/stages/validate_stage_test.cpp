#include "oraclegs/pipeline/stages/validate_stage.h"

#include "networks/vggt_fixture.h"
#include "oraclegs/pipeline/workspace/non_commercial.h"
#include "oraclegs/pipeline/workspace/stage_table.h"
#include "pipeline/proposing.h"
#include "pipeline/weights.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

using ValidateStageTest = ProposingTest;

struct Result {
  std::vector<TrainView> views;
  fs::path root;
};

Result Validate(const RunRequest& request, const Listener& listener) {
  auto run = StartRun(request, listener);
  const Preparation prepared = Prepare(&run);
  const ProposalPlan plan = RunPropose(&run, prepared.photos, prepared.geometry, prepared.decided);
  return {RunValidate(&run, prepared.photos, prepared.geometry, plan), run.workspace.root()};
}

TEST_F(ValidateStageTest, GivesTrainingViewsWithConfidenceAndFilesToLookAt) {
  const Result result = Validate(Request(), recorder.AsListener());
  ASSERT_EQ(result.views.size(), 8u);
  for (const TrainView& view : result.views) {
    EXPECT_EQ(view.image.shape(), (std::vector<int64_t>{60, 80, 3}));
    EXPECT_EQ(view.confidence.shape(), (std::vector<int64_t>{60, 80}));
    EXPECT_GE(view.confidence.min().item<float>(), 0.f);
    EXPECT_LE(view.confidence.max().item<float>(), 1.f);
    EXPECT_GT(view.confidence.std().item<float>(), 0.01f);  // it tells pixels apart
    for (const char* folder : {"proposals", "confidence", "confidence/preview"}) {
      EXPECT_TRUE(fs::exists(result.root / folder / (view.name + ".png"))) << folder;
    }
  }
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("8 proposals, trusted to")));
}

TEST_F(ValidateStageTest, ReadsBackWhatItWrote) {
  const Result first = Validate(Request(), Silent()), again = Validate(Request(), Silent());
  ASSERT_EQ(again.views.size(), first.views.size());
  for (size_t v = 0; v < first.views.size(); ++v) {
    EXPECT_EQ(again.views[v].name, first.views[v].name);
    EXPECT_TRUE(torch::equal(again.views[v].image, first.views[v].image));
    EXPECT_TRUE(torch::equal(again.views[v].confidence, first.views[v].confidence));
  }
}

TEST_F(ValidateStageTest, TrustsAllWhenToldTo) {
  auto request = Request("uniform");
  request.options.validate.oracle = "uniform";
  for (const TrainView& view : Validate(request, Silent()).views) EXPECT_EQ(view.confidence.min().item<float>(), 1.f);
}

TEST_F(ValidateStageTest, LeavesOutWhatIsTrustedNowhere) {
  const fs::path folder = *temp / "ready" / "synthetic_1", maps = *temp / "ready" / "synthetic_1_attention_maps";
  auto request = Request("ready_out");
  request.options.propose.proposers = "none";
  request.options.propose.proposal_folder = *temp / "ready";
  fs::create_directories(folder);
  std::vector<std::string> names;
  {
    auto run = StartRun(request, Silent());
    for (const int v : SpareViews(run))
      names.push_back(fs::path(run.scene.views[static_cast<size_t>(v)].name).filename());
  }
  for (size_t i = 0; i < 2; ++i) {
    WritePng(folder / names[i], Image8{80, 60, 3, std::vector<uint8_t>(size_t{80} * 60 * 3, 90)});
    WritePng(maps / names[i], Image8{80, 60, 1, std::vector<uint8_t>(size_t{80} * 60, i == 0 ? 0 : 255)});
  }
  const Result result = Validate(request, recorder.AsListener());
  ASSERT_EQ(result.views.size(), 1u);
  EXPECT_EQ(result.views[0].confidence.min().item<float>(), 1.f);
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("trusts nothing of 1 of 2 proposals, which are left out")));

  recorder.warnings.clear(), recorder.notes.clear();
  WritePng(maps / names[1], Image8{80, 60, 1, std::vector<uint8_t>(size_t{80} * 60, 0)});
  EXPECT_THAT(Validate(request, recorder.AsListener()).views, IsEmpty());
  EXPECT_THAT(recorder.warnings,
              Contains(testing::AllOf(HasSubstr("trusts nothing of 2 of 2"), HasSubstr("photographs alone are trained"),
                                      HasSubstr("--trajectory"))));
  EXPECT_THAT(recorder.notes, testing::Not(Contains(HasSubstr("trusted to")))) << "there is nothing to take a mean of";
}

TEST_F(ValidateStageTest, ADamagedPictureIsNamed) {
  const Result result = Validate(Request("damaged"), Silent());
  const fs::path file = result.root / "proposals" / (result.views[0].name + ".png");
  WritePng(file, Image8{3, 3, 3, std::vector<uint8_t>(27, 1)});
  EXPECT_THAT(MessageOf<InputError>([&] { Validate(Request("damaged"), Silent()); }),
              testing::AllOf(HasSubstr(file.string()), HasSubstr("delete it and run again")));
  fs::remove(file);
  EXPECT_EQ(Validate(Request("damaged"), Silent()).views.size(), result.views.size());
}

TEST_F(ValidateStageTest, WeightsOfVggtAreUsedWhereTheyAre) {
  const ModelsAt models(*temp / "models");
  auto request = Request("network");
  request.options.validate.oracle = "auto";
  request.options.propose.proposers = "warp";
  const Result without = Validate(request, recorder.AsListener());
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("`oraclegs models fetch vggt` brings its weights")));
  EXPECT_THAT(NonCommercialParts(WorkspacePaths(without.root)), IsEmpty());
  WriteTinyVggt(*temp / "models" / "vggt" / "model.safetensors");
  const Result with = Validate(request, recorder.AsListener());
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("VGGT-1B with the photographs")));
  ASSERT_EQ(with.views.size(), without.views.size());
  EXPECT_FALSE(torch::equal(with.views[0].confidence, without.views[0].confidence));
  EXPECT_THAT(NonCommercialParts(WorkspacePaths(with.root)), testing::ElementsAre("VGGT-1B"));
  const nlohmann::json record = ReadStageRecords(with.root).at("validate");
  EXPECT_EQ(record.at("oracle"), "vggt+consistency");
  EXPECT_EQ(record.at("chunk"), 8);
  const Result again = Validate(request, Silent());
  for (size_t v = 0; v < with.views.size(); ++v) {
    EXPECT_TRUE(torch::equal(again.views[v].confidence, with.views[v].confidence));
  }
  fs::remove_all(*temp / "models");
}

TEST_F(ValidateStageTest, AnOracleWithoutWeightsIsRefusedBeforeAnythingIsWritten) {
  const ModelsAt models(*temp / "no_models");
  auto request = Request("refused");
  request.options.validate.oracle = "vggt";
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }),
              HasSubstr("--oracle vggt needs the weights"));
  EXPECT_FALSE(fs::exists(request.out));
  request.options.propose.proposers = "none";  // nothing to judge
  EXPECT_NO_THROW(StartRun(request, Silent()));
}

TEST_F(ValidateStageTest, HasNothingToDoWithoutProposals) {
  auto run = StartRun(Request("nothing"), Silent());
  EXPECT_THAT(RunValidate(&run, {}, {}, {}), IsEmpty());
}

}  // namespace
}  // namespace oraclegs
