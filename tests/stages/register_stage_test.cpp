#include "oraclegs/stages/stage_works.h"

#include "run/fixtures.h"
#include "run/weights.h"
#include "support/errors.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

class PoseNetworkTest : public testing::Test {
 protected:
  PoseNetworkTest() {
    std::filesystem::create_directories(temp / "scene");
    options.input.poses = PoseSource::kVggt;
  }

  TempDir temp;
  const ModelsAt models{temp / "models"};
  RunOptions options;
  Workspace workspace = Workspace::Claim(temp / "out", temp / "scene", {}, false);
};

TEST_F(PoseNetworkTest, IsNothingForColmap) {
  options.input.poses = PoseSource::kColmap;
  EXPECT_FALSE(PoseNetworkOf(options, workspace).has_value());
}

TEST_F(PoseNetworkTest, IsTheOneThatIsHere) {
  SKIP_WITHOUT_NETWORKS();
  WriteTinyVggt(temp / "models" / "vggt" / "model.safetensors");
  EXPECT_EQ(PoseNetworkOf(options, workspace)->name, "VGGT-1B");
}

TEST_F(PoseNetworkTest, IsTheRecordedOneWhereWeightsAreGone) {
  EXPECT_THAT(MessageOf<InputError>([&] { PoseNetworkOf(options, workspace); }),
              testing::HasSubstr("--poses vggt needs the weights"));
  workspace.MarkDone("register", {{"key", "k"},
                                  {"network", {{"name", "VGGT-1B"}, {"fingerprint", "f"}, {"commercial", false}}},
                                  {"files", nlohmann::json::array()}});
  const std::optional<VggtWeights> network = PoseNetworkOf(options, workspace);
  ASSERT_TRUE(network.has_value());
  EXPECT_EQ(network->fingerprint, "f");
}

TEST(RegisterStage, KeepsThePosesThatResultsBelongTo) {
  const TempDir temp;
  auto run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), Silent());
  WriteText(run.workspace.point_cloud(), "x");
  WriteText(run.workspace.sfm() / "inputs.json", "{");
  EXPECT_THAT(MessageOf<RunError>([&] { RegisterStage().load(&run); }),
              testing::AllOf(testing::HasSubstr("inputs.json: is damaged"), testing::HasSubstr("bring the file back")));
}

TEST(RegisterStage, IsWantedForImagesWithoutPoses) {
  const TempDir temp;
  auto run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), Silent());
  EXPECT_FALSE(RegisterStage().wanted(run)) << "the scene has poses";
  EXPECT_EQ(StageKey(&run, Stages(), "register"), "");
  run.photos = "x";
  EXPECT_TRUE(RegisterStage().wanted(run));
  const std::string colmap = StageKey(&run, Stages(), "register");
  run.plan.poses = VggtWeights{"", "VGGT-1B", "f", false};
  EXPECT_NE(StageKey(&run, Stages(), "register"), colmap);
}

}  // namespace
}  // namespace oraclegs
