#include "oraclegs/stages/refined_poses.h"

#include "oraclegs/stages/stage_works.h"
#include "run/fixtures.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

class RefinedPosesTest : public testing::Test {
 protected:
  /// The run's training cameras, all moved by half a unit.
  std::vector<Camera> Moved() {
    std::vector<Camera> cameras = WorkingCameras(run.Given(), run.split.train, run.plan.image);
    for (Camera& camera : cameras) camera.cam_from_world.translation().x() += 0.5;
    return cameras;
  }
  void Record(const char* result) {
    run.workspace.MarkDone("poses",
                           {{"key", "k"}, {"seconds", 1}, {"result", result}, {"files", nlohmann::json::array()}});
  }
  void Write(const std::vector<Camera>& cameras) {
    WriteRefinedPoses(run.workspace.refined_poses(), NamesAt(run.scene, run.split.train), cameras);
  }
  const Eigen::Matrix4d PoseOf(int view) const {
    return run.scene.views[static_cast<size_t>(view)].cam_from_world->matrix();
  }

  TempDir temp;
  oraclegs::Run run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), Silent());
};

TEST_F(RefinedPosesTest, BringsBackWhatWasWrittenBitByBit) {
  std::filesystem::create_directories(run.workspace.sfm());
  const std::vector<Camera> cameras = Moved();
  Write(cameras);
  UseRefinedPoses(&run);
  EXPECT_FALSE(run.given) << "no stage refined them";
  Record("refined");
  for (int repeat = 0; repeat < 2; ++repeat) {
    UseRefinedPoses(&run);
    ASSERT_TRUE(run.given);
    for (size_t t = 0; t < cameras.size(); ++t) {
      EXPECT_EQ(PoseOf(run.split.train[t]), cameras[t].cam_from_world.matrix());
    }
  }
  for (const int view : run.split.test) {
    EXPECT_NE(PoseOf(view), run.given->views[static_cast<size_t>(view)].cam_from_world->matrix());
  }
}

TEST_F(RefinedPosesTest, AreThoseOfTheRunOnceItIsOpened) {
  std::filesystem::create_directories(run.workspace.sfm());
  const std::vector<Camera> cameras = Moved();
  Write(cameras);
  Record("refined");
  const RunRequest request = TinyRequest(temp / "scene", temp / "out");
  { const oraclegs::Run held = std::move(run); }  // lets go of the workspace
  const oraclegs::Run opened = OpenRun(request, Silent());
  const auto first = static_cast<size_t>(opened.split.train[0]);
  EXPECT_EQ(opened.scene.views[first].cam_from_world->matrix(), cameras[0].cam_from_world.matrix());
}

TEST_F(RefinedPosesTest, RefusesWhatIsNoPoseOrOfOtherPhotos) {
  std::filesystem::create_directories(run.workspace.sfm());
  Record("refined");
  const std::filesystem::path file = run.workspace.refined_poses();
  const auto refused = [&](const std::string& text) {
    WriteFileAtomically(file, text);
    return MessageOf<InputError>([&] { UseRefinedPoses(&run); });
  };
  EXPECT_THAT(refused("{"), HasSubstr("is not valid JSON"));
  EXPECT_THAT(refused("{}"), HasSubstr("does not have the poses of this run's photos"));
  EXPECT_THAT(refused(R"({"cam_from_world": {"other.png": []}})"), HasSubstr("does not have the poses"));
  std::vector<Camera> cameras = Moved();
  cameras[0].cam_from_world.linear() *= 2;
  Write(cameras);
  EXPECT_THAT(MessageOf<InputError>([&] { UseRefinedPoses(&run); }),
              HasSubstr("refined.json: has a pose that is none"));
}

}  // namespace
}  // namespace oraclegs
