#include "depth/disturbed.h"
#include "oraclegs/depth/refine_poses.h"
#include "oraclegs/depth/stereo_setup.h"
#include "oraclegs/stages/refined_poses.h"
#include "oraclegs/stages/stage_works.h"
#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

/// Neighbors of a demo scene, large enough to say where patches lie.
class PosesStageTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    temp = new TempDir;
    DemoSceneOptions options;
    options.width = 208, options.height = 156, options.samples = 2;
    WriteDemoScene(*temp / "scene", options, Silent());
  }
  static void TearDownTestSuite() { delete temp; }

  static RunRequest Request(const std::string& out) {
    RunRequest request = TinyRequest(*temp / "scene", *temp / out);
    request.options.depth.refine_poses = {};
    request.options.split = {};
    request.options.split.train_views = "010,011,013,014";
    request.options.split.test_views = "012";
    return request;
  }

  /// A run whose training photos came with wrong poses; the test photo's is right.
  oraclegs::Run StartDisturbed(const std::string& out, double degrees, double share) {
    auto run = StartRun(Request(out), recorder.AsListener());
    truth = run.scene;
    const std::vector<Camera> wrong =
        Disturbed(WorkingCameras(run.scene, run.split.train, run.plan.image), degrees, share, 0);
    for (size_t t = 0; t < wrong.size(); ++t) Train(&run.scene, run, t).cam_from_world = wrong[t].cam_from_world;
    GivePoints(&run, {});
    return run;
  }
  static SceneView& Train(Scene* scene, const oraclegs::Run& run, size_t t) {
    return scene->views[static_cast<size_t>(run.split.train[t])];
  }
  std::vector<Camera> Cameras(const Scene& scene, const oraclegs::Run& run) const {
    return WorkingCameras(scene, run.split.train, run.plan.image);
  }
  bool Stepped(const char* stage) const {
    return std::any_of(recorder.steps.begin(), recorder.steps.end(),
                       [&](const StepDone& step) { return step.stage == stage; });
  }

  static TempDir* temp;
  EventRecorder recorder;
  Scene truth;
};

TempDir* PosesStageTest::temp = nullptr;

TEST_F(PosesStageTest, KeepsPosesThatFitAndLendsDepthItsStereo) {
  auto run = StartDisturbed("true", 0, 0);
  Bring(&run, "poses");
  EXPECT_EQ(run.workspace.Record("poses").at("result"), "kept");
  EXPECT_FALSE(run.given);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("poses fit the photos within 0.")));
  EXPECT_TRUE(Stepped("poses"));
  EXPECT_EQ(Bring(&run, "depth").geometry.maps.size(), 4u);
  EXPECT_FALSE(Stepped("depth")) << "stereo ran twice";
}

TEST_F(PosesStageTest, RefinesPosesThatAreOff) {
  auto run = StartDisturbed("off", 0.3, 0.01);
  Bring(&run, "poses");
  const nlohmann::json record = run.workspace.Record("poses");
  EXPECT_EQ(record.at("result"), "refined");
  EXPECT_LT(record.at("after"), 0.5 * record.at("before").get<double>());
  EXPECT_EQ(record.at("views").size(), 4u);
  EXPECT_EQ(record.at("views")[0].at("name"), "images/010.png");
  EXPECT_GT(record.at("views")[1].at("degrees"), 0.01);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("(--refine-poses off keeps them)")));

  ASSERT_TRUE(run.given);
  const std::vector<Camera> right = Cameras(truth, run), given = Cameras(*run.given, run),
                            now = Cameras(run.scene, run);
  EXPECT_LT(MeanMovement(right, now).degrees, 0.5 * MeanMovement(right, given).degrees);
  const auto test = static_cast<size_t>(run.split.test[0]);
  const Camera before = WorkingCamera(truth.views[test], run.plan.image);
  const Camera expected = Following({before}, given, now).front();
  EXPECT_EQ(run.scene.views[test].cam_from_world->matrix(), expected.cam_from_world.matrix());
  EXPECT_EQ(ViewsOf(&run).views[2].camera.cam_from_world.matrix(), now[2].cam_from_world.matrix());
  EXPECT_EQ(Bring(&run, "depth").geometry.maps[2].camera.cam_from_world.matrix(), now[2].cam_from_world.matrix());
}

TEST_F(PosesStageTest, KeepsPosesThatManyPhotosBind) {
  auto run = StartDisturbed("many", 0.6, 0.02);
  run.photos = "registered";
  while (run.split.train.size() <= kMaxStereoViews) run.split.train.push_back(run.split.train.front());
  GivePoints(&run, {});
  Bring(&run, "poses");
  const nlohmann::json record = run.workspace.Record("poses");
  EXPECT_EQ(record.at("result"), "kept");
  EXPECT_GT(record.at("before"), PoseRefinementOptions().gate);
  EXPECT_FALSE(run.given);
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("px, and are kept, for stereo looks at 32 of the photos")));
  EXPECT_THAT(recorder.notes, testing::Not(Contains(HasSubstr("poses fit"))));
}

TEST_F(PosesStageTest, ReadsRefinedPosesBackAndMendsDamage) {
  std::vector<Eigen::Matrix4d> first;
  const auto poses = [](const oraclegs::Run& run) {
    std::vector<Eigen::Matrix4d> all;
    for (const SceneView& view : run.scene.views) all.push_back(view.cam_from_world->matrix());
    return all;
  };
  {
    auto run = StartDisturbed("again", 0.3, 0.01);
    Bring(&run, "depth");
    first = poses(run);
  }
  {
    recorder = {};
    auto run = StartDisturbed("again", 0.3, 0.01);
    Bring(&run, "depth");
    EXPECT_FALSE(Stepped("poses"));
    EXPECT_FALSE(Stepped("depth"));
    EXPECT_EQ(poses(run), first);
  }
  WriteFileAtomically(*temp / "again/sfm/refined.json", R"({"cam_from_world": {"images/010.png": [1, 2, 3]}})");
  recorder = {};
  auto run = StartDisturbed("again", 0.3, 0.01);
  Bring(&run, "poses");
  EXPECT_THAT(recorder.warnings,
              Contains(HasSubstr("refined.json: has a pose of 3 numbers; stage poses is made again")));
  EXPECT_EQ(poses(run), first);
}

TEST_F(PosesStageTest, LeavesPosesAloneWhereItIsNotWanted) {
  RunRequest request = Request("none");
  request.options.depth.refine_poses = PoseRefining::kOff;
  auto run = StartRun(request, Silent());
  EXPECT_FALSE(run.plan.refines_poses);
  GivePoints(&run, {});
  Bring(&run, "depth");
  EXPECT_TRUE(run.workspace.Record("poses").is_null());
}

TEST_F(PosesStageTest, SaysWhatNoSmallCorrectionMends) {
  auto run = StartDisturbed("far", 0.3, 0.15);
  Bring(&run, "poses");
  EXPECT_EQ(run.workspace.Record("poses").at("result"), "undone");
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("no small correction fixes them")));
  for (const SceneView& view : run.scene.views) {
    EXPECT_FALSE(view.cam_from_world->matrix().isApprox(Eigen::Matrix4d::Identity()));
  }
  const std::vector<Camera> given = Cameras(run.Given(), run), now = Cameras(run.scene, run);
  for (size_t t = 0; t < now.size(); ++t) {
    EXPECT_EQ(now[t].cam_from_world.matrix(), given[t].cam_from_world.matrix());
  }
}

}  // namespace
}  // namespace oraclegs
