#include "oraclegs/stages/stage_works.h"

#include "oraclegs/image/codecs.h"
#include "oraclegs/workspace/non_commercial.h"
#include "oraclegs/workspace/stage_records.h"
#include "run/proposing.h"
#include "run/weights.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "support/network_files.h"

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
  std::vector<TrainView> views = Bring(&run, "validate").proposals;
  for (TrainView& view : views) {
    EXPECT_FALSE(view.image.defined() || view.pixel_weight.defined()) << "bytes take a quarter of the memory";
    view.image = view.Image(), view.pixel_weight = view.Weights();
  }
  return {std::move(views), run.workspace.root()};
}

TEST_F(ValidateStageTest, GivesTrainingViewsWithConfidenceAndFilesToLookAt) {
  const Result result = Validate(Request(), recorder.AsListener());
  ASSERT_EQ(result.views.size(), 8u);
  for (const TrainView& view : result.views) {
    EXPECT_EQ(view.image.shape(), Shape({60, 80, 3}));
    EXPECT_EQ(view.pixel_weight.shape(), Shape({60, 80}));
    const auto confidence = Flat(view.pixel_weight);
    EXPECT_GE(confidence.minCoeff(), 0.f);
    EXPECT_LE(confidence.maxCoeff(), 1.f);
    EXPECT_GT(std::sqrt((confidence - confidence.mean()).square().mean()), 0.01f);  // it orders pixels
    for (const char* folder : {"proposals", "confidence"}) {
      EXPECT_TRUE(fs::exists(result.root / folder / (view.name + ".png"))) << folder;
    }
    EXPECT_TRUE(fs::exists(result.root / "confidence/preview" / (view.name + ".jpg")));
  }
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("8 proposals, mean confidence")));
}

TEST_F(ValidateStageTest, ReadsBackWhatItWrote) {
  const Result first = Validate(Request(), Silent()), again = Validate(Request(), Silent());
  ASSERT_EQ(again.views.size(), first.views.size());
  for (size_t v = 0; v < first.views.size(); ++v) {
    EXPECT_EQ(again.views[v].name, first.views[v].name);
    EXPECT_TRUE(Equal(again.views[v].image, first.views[v].image));
    EXPECT_TRUE(Equal(again.views[v].pixel_weight, first.views[v].pixel_weight));
  }
}

TEST_F(ValidateStageTest, TrustsAllWithTheUniformOracle) {
  auto request = Request("uniform");
  request.options.validate.oracle = OracleKind::kUniform;
  for (const TrainView& view : Validate(request, Silent()).views) EXPECT_EQ(Flat(view.pixel_weight).minCoeff(), 1.f);
}

TEST_F(ValidateStageTest, LeavesOutWhatIsTrustedNowhere) {
  const fs::path folder = *temp / "ready" / "synthetic_1", maps = *temp / "ready" / "synthetic_1_attention_maps";
  auto request = Request("ready_out");
  request.options.propose.proposers = std::string("none");
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
  EXPECT_EQ(Flat(result.views[0].pixel_weight).minCoeff(), 1.f);
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("1 of 2 proposals have no confidence anywhere and are left out")));

  recorder.warnings.clear(), recorder.notes.clear();
  WritePng(maps / names[1], Image8{80, 60, 1, std::vector<uint8_t>(size_t{80} * 60, 0)});
  EXPECT_THAT(Validate(request, recorder.AsListener()).views, IsEmpty());
  EXPECT_THAT(recorder.warnings,
              Contains(testing::AllOf(HasSubstr("2 of 2 proposals have no confidence"),
                                      HasSubstr("photos alone are trained"), HasSubstr("--trajectory"))));
  EXPECT_THAT(recorder.notes, testing::Not(Contains(HasSubstr("mean confidence"))))
      << "there is nothing to take a mean of";
}

TEST_F(ValidateStageTest, LeavesOutNothingWhereConfidenceHasNoLevel) {
  auto request = Request("as_it_is");
  const Result all = Validate(request, Silent());
  const fs::path root = all.root;
  for (const TrainView& view : all.views) {
    const int width = view.camera.width, height = view.camera.height;
    WritePng(root / "confidence" / (view.name + ".png"),
             Image8{width, height, 1, std::vector<uint8_t>(static_cast<size_t>(width) * height, 1)});
  }
  EXPECT_THAT(Validate(request, Silent()).views, IsEmpty()) << "a mean of 1/255 is no confidence";
  request.options.validate.calibrate = false;
  const Result raw = Validate(request, Silent());
  ASSERT_FALSE(raw.views.empty());
  for (const TrainView& view : raw.views) {
    const int width = view.camera.width, height = view.camera.height;
    WritePng(root / "confidence" / (view.name + ".png"),
             Image8{width, height, 1, std::vector<uint8_t>(static_cast<size_t>(width) * height, 1)});
  }
  EXPECT_EQ(Validate(request, Silent()).views.size(), raw.views.size());
}

TEST_F(ValidateStageTest, IsMadeAgainWhereAnImageIsDamaged) {
  const Result result = Validate(Request("damaged"), Silent());
  const fs::path file = result.root / "proposals" / (result.views[0].name + ".png");
  WritePng(file, Image8{3, 3, 3, std::vector<uint8_t>(27, 1)});
  const Result again = Validate(Request("damaged"), recorder.AsListener());
  EXPECT_THAT(recorder.warnings,
              Contains(testing::AllOf(HasSubstr(file.string()), HasSubstr("stage validate is made again"))));
  ASSERT_EQ(again.views.size(), result.views.size());
  for (size_t v = 0; v < again.views.size(); ++v) {
    EXPECT_TRUE(Equal(again.views[v].image, result.views[v].image));
    EXPECT_TRUE(Equal(again.views[v].pixel_weight, result.views[v].pixel_weight));
  }
  fs::remove(file);
  EXPECT_EQ(Validate(Request("damaged"), Silent()).views.size(), result.views.size());
}

TEST_F(ValidateStageTest, UsesWeightsOfVggtWhereTheyAre) {
  SKIP_WITHOUT_NETWORKS();
  const ModelsAt models(*temp / "models");
  auto request = Request("network");
  request.options.validate.oracle = {};
  request.options.propose.proposers = std::string("warp");
  const Result without = Validate(request, recorder.AsListener());
  EXPECT_THAT(recorder.notes, Not(Contains(HasSubstr("VGGT")))) << "nobody asked for it";
  EXPECT_THAT(NonCommercialParts(WorkspacePaths(without.root)), IsEmpty());
  WriteTinyVggt(*temp / "models" / "vggt" / "model.safetensors");
  const Result with = Validate(request, recorder.AsListener());
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("VGGT-1B with the images")));
  ASSERT_EQ(with.views.size(), without.views.size());
  EXPECT_FALSE(Equal(with.views[0].pixel_weight, without.views[0].pixel_weight));
  EXPECT_THAT(NonCommercialParts(WorkspacePaths(with.root)), testing::ElementsAre("VGGT-1B"));
  const nlohmann::json record = ReadStageRecords(with.root).at("validate");
  EXPECT_EQ(record.at("oracle"), "vggt+consistency");
  EXPECT_EQ(record.at("chunk"), 8);
  const Result again = Validate(request, Silent());
  for (size_t v = 0; v < with.views.size(); ++v) {
    EXPECT_TRUE(Equal(again.views[v].pixel_weight, with.views[v].pixel_weight));
  }
  fs::remove_all(*temp / "models");
}

TEST_F(ValidateStageTest, RefusesAnOracleWithoutWeightsBeforeWriting) {
  const ModelsAt models(*temp / "no_models");
  auto request = Request("refused");
  request.options.validate.oracle = OracleKind::kVggt;
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }),
              HasSubstr("--oracle vggt needs the weights"));
  EXPECT_FALSE(fs::exists(request.out));
  request.options.propose.proposers = std::string("none");  // nothing to validate
  EXPECT_NO_THROW(StartRun(request, Silent()));
}

TEST_F(ValidateStageTest, DoesNothingWithoutProposals) {
  RunRequest request = Request("nothing");
  request.options.propose.proposers = std::string("none");
  EXPECT_THAT(Validate(request, recorder.AsListener()).views, IsEmpty());
  EXPECT_THAT(recorder.started, testing::Not(Contains("validate")));
}

TEST_F(ValidateStageTest, GivesTheSameFromKeptCandidatesAndFromOnesMadeAgain) {
  RunRequest request = Request("kept");
  request.options.propose.proposers = std::string("warp");
  auto kept = StartRun(request, Silent());
  EXPECT_GT(Bring(&kept, "propose").candidates.bytes(), 0u);
  const std::vector<TrainView> from_kept = Bring(&kept, "validate").proposals;
  EXPECT_EQ(kept.results->candidates.bytes(), 0u) << "given up";
  request.out = *temp / "again";
  {
    auto run = StartRun(request, Silent());
    Bring(&run, "propose");
  }
  auto again = StartRun(request, Silent());
  const std::vector<TrainView> made_again = Bring(&again, "validate").proposals;
  ASSERT_EQ(from_kept.size(), made_again.size());
  for (size_t v = 0; v < made_again.size(); ++v) {
    EXPECT_TRUE(Equal(from_kept[v].image, made_again[v].image));
    EXPECT_TRUE(Equal(from_kept[v].pixel_weight, made_again[v].pixel_weight));
  }
}

}  // namespace
}  // namespace oraclegs
