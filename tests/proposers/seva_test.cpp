#include "oraclegs/proposers/seva.h"

#include "oraclegs/core/interrupt.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/stages/proposer_row.h"
#include "run/proposing.h"
#include "run/weights.h"
#include "support/errors.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Stage with random networks of a few thousand numbers in temp/models.
class SevaStageTest : public ProposingTest {
 protected:
  static void SetUpTestSuite() {
    ProposingTest::SetUpTestSuite();
    if (HasNetworks()) WriteTinyNetworks(*temp / "models");
  }
  void SetUp() override { SKIP_WITHOUT_NETWORKS(); }

  static RunRequest SevaRequestOf(const std::string& out, const std::string& proposers) {
    RunRequest request = Request(out);
    request.options.propose.proposers = proposers;
    request.options.trajectory.proposals = 3;
    request.options.seva.frames = 16;
    request.options.seva.short_side = 64;
    request.options.seva.steps = 1;
    return request;
  }

  /// The generated images of a run.
  static std::vector<std::string> ImagesOf(const fs::path& out) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(out / "proposals" / "seva")) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<std::string> bytes;
    for (const fs::path& file : files) bytes.push_back(ReadFile(file));
    return bytes;
  }

  const ModelsAt models{*temp / "models"};
};

TEST_F(SevaStageTest, GeneratesCandidatesOfEveryTarget) {
  RunRequest request = SevaRequestOf("seva", "seva");
  request.options.seva.candidates = 2;
  auto run = StartRun(request, recorder.AsListener());
  const StageResults& known = Bring(&run, "propose");
  ASSERT_EQ(known.targets.size(), 3u);
  EXPECT_TRUE(known.proxies.empty());
  for (const Target& target : known.targets) {
    for (const char* source : {"seva", "seva_2"}) {
      const Image8 image = ReadImage(run.workspace.proposals() / source / (target.name + ".png"));
      EXPECT_EQ(image.width, target.camera.width);
      EXPECT_EQ(image.height, target.camera.height);
    }
    EXPECT_FALSE(fs::exists(run.workspace.proposals() / "warp" / (target.name + ".png")));
  }
  EXPECT_TRUE(fs::exists(run.workspace.proposals() / "transforms.json"));
  EXPECT_FALSE(fs::exists(run.workspace.proposals() / "seva_chunks")) << "they are needed no more";
  const auto answers =
      ProposersOf(&run).Ask({known.targets[0], {"held_out", ViewsOf(&run).views[0].camera}}, {std::nullopt, 0});
  ASSERT_EQ(answers[0].size(), 2u);
  EXPECT_EQ(answers[0][0].source, "seva");
  EXPECT_EQ(answers[0][1].source, "seva_2");
  ASSERT_EQ(answers[1].size(), 1u);
  EXPECT_EQ(answers[1][0].source, "warp");  // what the oracle learns from
  EXPECT_EQ(run.workspace.Record("propose").at("non_commercial"), nlohmann::json::array({"Stable Virtual Camera"}));
}

TEST_F(SevaStageTest, ProposalsMayKeepTheGeneratorsSize) {
  RunRequest request = SevaRequestOf("own_size", "seva");
  request.options.propose.proposal_size = ProposalSize::kOwn;
  request.options.validate.oracle = OracleKind::kUniform;
  auto run = StartRun(request, recorder.AsListener());
  const StageResults& known = Bring(&run, "validate");
  ASSERT_EQ(known.proposals.size(), 3u);
  const Camera& photo = ViewsOf(&run).views[0].camera;
  for (const TrainView& view : known.proposals) {
    EXPECT_EQ(view.camera.width, 64) << "80 x 60 in 64 x 64";
    EXPECT_EQ(view.camera.height, 48);
    EXPECT_NEAR(view.camera.fx / photo.fx, 0.8, 1e-9);
    EXPECT_EQ(view.Image().shape(), (Shape{48, 64, 3}));
  }
}

TEST_F(SevaStageTest, GoesOnBehindTheLastFinishedChunk) {
  int64_t done = 0, total = 0, stop_after = 0;
  const Listener listener = [&](const Event& event) {
    const auto* step = std::get_if<StepDone>(&event);
    if (!step || step->unit != "denoising steps") return;
    done = step->done, total = step->total;
    if (done == stop_after) RequestInterrupt(true);
  };
  const auto propose = [&](const std::string& out) {
    auto run = StartRun(SevaRequestOf(out, "seva"), listener);
    Bring(&run, "depth");
    done = total = 0;
    Bring(&run, "propose");
  };
  propose("straight");
  const int64_t chunks = total;  // of one step each
  ASSERT_GE(chunks, 2);
  stop_after = 2;
  EXPECT_THROW(propose("stopped"), Interrupted);
  RequestInterrupt(false);
  EXPECT_TRUE(fs::exists(*temp / "stopped" / "proposals" / "seva_chunks"));
  stop_after = 0;
  propose("stopped");
  EXPECT_EQ(total, chunks - 1);
  EXPECT_EQ(done, total);
  EXPECT_EQ(ImagesOf(*temp / "stopped"), ImagesOf(*temp / "straight"));
}

TEST_F(SevaStageTest, AWholeRunWithEveryNetwork) {
  RunRequest request = SevaRequestOf("whole", "proxies,warp,seva");
  request.options.depth.depth_prior = DepthPrior::kFused;
  request.options.validate.oracle = OracleKind::kVggtAndConsistency;
  request.options.weights.lpips = LpipsUse::kRequired;
  const nlohmann::json metrics = Reconstruct(request, recorder.AsListener());
  for (const char* folder : {"proposals/seva", "proposals/warp", "proposals/proxies", "confidence"}) {
    EXPECT_TRUE(fs::exists(request.out / folder)) << folder;
  }
  EXPECT_EQ(metrics.at("depth").at("prior"), "fused");
  EXPECT_TRUE(metrics.at("test").contains("lpips"));
  EXPECT_TRUE(metrics.at("train").at("lpips").is_string());
  EXPECT_EQ(metrics.at("non_commercial"), nlohmann::json::array({"Stable Virtual Camera", "VGGT-1B"}));
  EXPECT_THAT(ReadFile(request.out / "point_cloud.ply").substr(0, 1000),
              HasSubstr("comment not for commercial use: made with Stable Virtual Camera\n"));
}

TEST_F(SevaStageTest, OtherOptionsAndWeightsGiveAnotherKey) {
  const TempDir dir;
  const ModelsAt own(dir.path());
  WriteTinySeva(dir.path());
  RunOptions options;
  const auto key = [&] { return SevaKey(options.seva, FindSevaFiles(options.weights)); };
  const std::string before = key();
  options.seva.seed = 24;
  EXPECT_NE(key(), before);
  options = {};
  options.seva.halves = seva::Halves::kInTurn;
  EXPECT_EQ(key(), before) << "where it is computed is no reason to do it again";
  options.weights.seva_weights = dir / "openclip-vith14/model.safetensors";
  EXPECT_NE(key(), before) << "another file was named";
  options.weights.seva_weights = dir / "nowhere.safetensors";
  EXPECT_THAT(MessageOf<InputError>([&] { key(); }), HasSubstr("nowhere.safetensors: does not exist"));
  options = {};
  fs::copy_file(dir / "seva/model.safetensors", dir / "sd21-vae/model.safetensors",
                fs::copy_options::overwrite_existing);
  EXPECT_NE(key(), before);
  fs::remove(dir / "openclip-vith14/model.safetensors");
  EXPECT_THAT(MessageOf<InputError>([&] { key(); }), HasSubstr("`oraclegs models fetch openclip-vith14`"));
}

TEST(RemoveGenerated, LeavesOtherFolders) {
  const TempDir dir;
  for (const char* name : {"seva", "seva_2", "seva_13", "seva_", "seva_chunks", "sevan", "warp"}) {
    fs::create_directory(dir / name);
  }
  RemoveGenerated(dir.path());
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(dir.path())) left.push_back(entry.path().filename().string());
  std::sort(left.begin(), left.end());
  EXPECT_THAT(left, ElementsAre("seva_", "seva_chunks", "sevan", "warp"));
  RemoveChunks(dir.path());
  EXPECT_FALSE(fs::exists(dir / "seva_chunks"));
}

}  // namespace
}  // namespace oraclegs
