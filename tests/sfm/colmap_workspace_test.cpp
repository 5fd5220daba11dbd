#include "oraclegs/sfm/colmap_workspace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/scene/colmap_files.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/sfm/register_views.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::vector<int> kViews{0, 2, 3};  // view 1 is held out

/// An environment without programs: success shows that colmap did not run.
class NoPrograms {
 public:
  NoPrograms() : old_(std::getenv("PATH")) { setenv("PATH", "/nowhere", 1); }
  ~NoPrograms() { setenv("PATH", old_.c_str(), 1); }
  NoPrograms(const NoPrograms&) = delete;
  NoPrograms& operator=(const NoPrograms&) = delete;

 private:
  std::string old_;
};

/// Four posed views of a few pixels whose numbers have no short decimal form.
Scene WriteSmallScene(const fs::path& dir) {
  Scene scene;
  scene.root = dir;
  scene.format = SceneFormat::kTransforms;
  for (int v = 0; v < 4; ++v) {
    SceneView view;
    view.name = std::to_string(v) + ".png";
    view.image_path = dir / view.name;
    WriteImage(view.image_path);
    view.intrinsics = {CameraModel::kPinhole, 6, 4, {1. / 3, 5.1, 3, 2}};
    view.cam_from_world = Eigen::Isometry3d::Identity();
    view.cam_from_world->translation() = Eigen::Vector3d(.1 * v, -1. / 7, 1e-17);
    scene.views.push_back(std::move(view));
  }
  return scene;
}

/// A finished run of kViews by hand: the model has view 3 as image 5 and view 0 as image 8, and two points.
void WriteFinishedRun(const Scene& scene, const fs::path& work_dir) {
  const auto plan = PlanStaging(scene, kViews);
  StageImages(scene, kViews, plan, work_dir);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  const Intrinsics refined{CameraModel::kSimplePinhole, 6, 4, {7, 3, 2}};
  const fs::path model = work_dir / "sparse" / "0";
  WriteColmapText(model, {{2, refined}}, {{5, plan[2].name, 2, pose}, {8, plan[0].name, 2, pose}});
  WriteText(model / "points3D.txt", "1 1 2 3 10 20 30 0.5 5 0 8 0\n2 4 5 6 0 0 0 0.5 8 1\n");
  MarkDone(work_dir, DescribeInputs(scene, kViews));
}

TEST(IsUnchanged, AcceptsTheSameInputs) {
  const TempDir dir;
  const Scene scene = WriteSmallScene(dir / "scene");
  EXPECT_FALSE(IsUnchanged(dir / "sfm", DescribeInputs(scene, kViews))) << "nothing is there yet";
  MarkDone(dir / "sfm", DescribeInputs(scene, kViews));  // also makes the folder
  EXPECT_TRUE(IsUnchanged(dir / "sfm", DescribeInputs(scene, kViews))) << "numbers must survive the file to the bit";
}

TEST(IsUnchanged, RefusesChangedInputs) {
  const TempDir dir;
  const Scene scene = WriteSmallScene(dir / "scene");
  MarkDone(dir / "sfm", DescribeInputs(scene, kViews));
  const auto unchanged_with = [&](auto change) {
    Scene other = scene;
    change(other.views[2]);
    return IsUnchanged(dir / "sfm", DescribeInputs(other, kViews));
  };
  ASSERT_TRUE(unchanged_with([](SceneView&) {}));
  EXPECT_FALSE(unchanged_with(
      [](SceneView& view) { view.intrinsics.params[0] = std::nextafter(view.intrinsics.params[0], 1); }));
  EXPECT_FALSE(unchanged_with([](SceneView& view) { view.intrinsics.model = CameraModel::kFov; }));
  EXPECT_FALSE(unchanged_with([](SceneView& view) { view.intrinsics.width = 12; }));
  EXPECT_FALSE(unchanged_with([](SceneView& view) { view.cam_from_world->translation().z() = 2e-17; }));
  EXPECT_FALSE(unchanged_with([](SceneView& view) { view.cam_from_world.reset(); }));
  EXPECT_FALSE(unchanged_with([](SceneView& view) { view.name = "other.png"; }));
  EXPECT_FALSE(unchanged_with([](SceneView& view) { view.as_stored = true; }));
  EXPECT_FALSE(unchanged_with([&](SceneView& view) { view.mask_path = scene.views[0].image_path; }));
  EXPECT_FALSE(IsUnchanged(dir / "sfm", DescribeInputs(scene, {0, 1, 2, 3})));
  EXPECT_FALSE(IsUnchanged(dir / "sfm", DescribeInputs(scene, {0, 2})));

  // The held-out view is no input.
  WriteImage(scene.views[1].image_path, 9, 9);
  EXPECT_TRUE(IsUnchanged(dir / "sfm", DescribeInputs(scene, kViews)));
  // A file with equal bytes, written later, is no change.
  const fs::path photo = scene.views[2].image_path;
  const auto written = fs::last_write_time(photo);
  fs::last_write_time(photo, written + std::chrono::seconds(1));
  EXPECT_TRUE(IsUnchanged(dir / "sfm", DescribeInputs(scene, kViews)));
  // Other bytes that claim to be of the same time.
  WriteImage(photo, 40, 40);
  fs::last_write_time(photo, written);
  EXPECT_FALSE(IsUnchanged(dir / "sfm", DescribeInputs(scene, kViews)));
}

TEST(IsUnchanged, RefusesADamagedFile) {
  const TempDir dir;
  const nlohmann::json inputs = {{"format", 1}, {"images", {1, 2, 3}}};
  MarkDone(dir.path(), inputs);
  const std::string whole = ReadFile(dir / "inputs.json");
  for (const std::string& bytes : {std::string(), whole.substr(0, whole.size() / 2), std::string("\xFF\0{", 3),
                                   whole + "{", std::string(100000, '[')}) {
    WriteText(dir / "inputs.json", bytes);
    EXPECT_FALSE(IsUnchanged(dir.path(), inputs)) << bytes.substr(0, 40);
  }
  fs::remove(dir / "inputs.json");
  fs::create_directories(dir / "inputs.json");
  EXPECT_FALSE(IsUnchanged(dir.path(), inputs)) << "a folder of that name";
  fs::remove(dir / "inputs.json");
  MarkDone(dir.path(), inputs);
  EXPECT_TRUE(IsUnchanged(dir.path(), inputs));
}

TEST(IsUnchanged, RefusesAnUnreadableFolder) {
  const TempDir dir;
  EXPECT_FALSE(IsUnchanged(dir / std::string(300, 'x'), {}));  // longer than a name may be
}

TEST(ClearWorkDir, RemovesOnlyWhatARunLeaves) {
  const TempDir dir;
  const fs::path work_dir = dir / "sfm";
  WriteFinishedRun(WriteSmallScene(dir / "scene"), work_dir);
  for (const char* name : {"database.db", "database.db-wal", "database.db-shm", "colmap.log", "points.ply",
                           "attempts/poses/cameras.txt", "attempts/model/cameras.bin", "registration.json",
                           "masks/camera0/0.png.png", "mine.txt", "sparse.bak/cameras.bin"}) {
    WriteText(work_dir / name, "x");
  }
  ClearWorkDir(work_dir);
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(work_dir)) left.push_back(entry.path().filename());
  EXPECT_THAT(left, testing::UnorderedElementsAre("mine.txt", "sparse.bak"));
  for (int v = 0; v < 4; ++v) {
    EXPECT_TRUE(fs::exists(dir / "scene" / (std::to_string(v) + ".png"))) << "an image behind a link is gone";
  }
}

TEST(RemoveAttempts, LeavesTheResult) {
  const TempDir dir;
  for (const char* name : {"attempts/models3/cameras.bin", "attempts/pairs.txt", "attempts/features1.db", "database.db",
                           "sparse/0/cameras.bin", "registration.json"}) {
    WriteText(dir / name, "x");
  }
  RemoveAttempts(dir.path());
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(dir.path())) left.push_back(entry.path().filename());
  EXPECT_THAT(left, testing::UnorderedElementsAre("database.db", "sparse", "registration.json"));
}

TEST(ClearWorkDir, MakesTheFolder) {
  const TempDir dir;
  ClearWorkDir(dir / "a/b");
  EXPECT_TRUE(fs::is_empty(dir / "a/b"));
  WriteText(dir / "file", "x");
  EXPECT_THAT(MessageOf<RunError>([&] { ClearWorkDir(dir / "file"); }), HasSubstr((dir / "file").string()));
  EXPECT_THAT(MessageOf<RunError>([&] { ClearWorkDir(dir / "file/below"); }), HasSubstr((dir / "file").string()));
  EXPECT_EQ(ReadFile(dir / "file"), "x");
}

TEST(MakeFolder, MakesParents) {
  const TempDir dir;
  MakeFolder(dir / "a/b");
  WriteText(dir / "a/b/file", "x");
  MakeFolder(dir / "a/b");
  EXPECT_TRUE(fs::exists(dir / "a/b/file"));
  EXPECT_THAT(MessageOf<RunError>([&] { MakeFolder(dir / "a/b/file/c"); }),
              StartsWith((dir / "a/b/file/c").string() + ": cannot be made: "));
}

TEST(MoveTo, ReplacesTheTarget) {
  const TempDir dir;
  WriteText(dir / "models/0/new", "new");
  WriteText(dir / "sparse/0/old", "old");
  MoveTo(dir / "models/0", dir / "sparse/0");
  EXPECT_FALSE(fs::exists(dir / "models/0"));
  EXPECT_FALSE(fs::exists(dir / "sparse/0/old"));
  EXPECT_EQ(ReadFile(dir / "sparse/0/new"), "new");
  MoveTo(dir / "sparse/0", dir / "x/y/z");  // the parents are made
  EXPECT_EQ(ReadFile(dir / "x/y/z/new"), "new");
  EXPECT_THAT(MessageOf<RunError>([&] { MoveTo(dir / "gone", dir / "there"); }),
              AllOf(StartsWith((dir / "gone").string() + ": cannot be renamed"), HasSubstr((dir / "there").string())));
  WriteText(dir / "file", "x");
  EXPECT_THAT(MessageOf<RunError>([&] { MoveTo(dir / "x/y/z", dir / "file/z"); }), HasSubstr("Not a directory"));
}

TEST(ReadModel, UsesIndicesOfTheScene) {
  const TempDir dir;
  const Scene scene = WriteSmallScene(dir / "scene");
  WriteFinishedRun(scene, dir / "sfm");
  const auto model = ReadModel(scene, kViews, PlanStaging(scene, kViews), dir / "sfm", Silent());
  ASSERT_EQ(model.views.size(), 2u);  // view 2 did not register
  for (const int v : {0, 3}) {
    const SceneView& view = model.views.at(v);
    EXPECT_EQ(view.name, scene.views[v].name);
    EXPECT_EQ(view.image_path, scene.views[v].image_path) << "the image, not the link to it";
    EXPECT_FALSE(view.as_stored) << "it was staged upright";
    EXPECT_EQ(view.intrinsics.model, CameraModel::kSimplePinhole);
    EXPECT_EQ(view.intrinsics.params, (std::vector<double>{7, 3, 2}));
    EXPECT_EQ(view.cam_from_world->translation(), Eigen::Vector3d(1, 2, 3));
  }
  ASSERT_EQ(model.points.size(), 2u);
  EXPECT_EQ(model.points[0].xyz, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(model.points[0].rgb, ElementsAre(10, 20, 30));
  EXPECT_THAT(model.points[0].views, ElementsAre(0, 3)) << "ascending";
  EXPECT_THAT(model.points[1].views, ElementsAre(0));
}

TEST(ReadModel, RefusesAMissingDamagedOrForeignModel) {
  const TempDir dir;
  const Scene scene = WriteSmallScene(dir / "scene");
  const auto plan = PlanStaging(scene, kViews);
  const auto error = [&] {
    return MessageOf<InputError>([&] { ReadModel(scene, kViews, plan, dir / "sfm", Silent()); });
  };
  EXPECT_THAT(error(), HasSubstr((dir / "sfm/sparse/0").string()));
  WriteFinishedRun(scene, dir / "sfm");
  WriteImage(dir / "sfm/images/stranger.png");
  WriteColmapText(dir / "sfm/sparse/0", {{2, scene.views[0].intrinsics}},
                  {{5, plan[0].name, 2}, {6, "stranger.png", 2}});
  EXPECT_THAT(error(), AllOf(StartsWith((dir / "sfm").string() + ": "), HasSubstr("stranger.png")));
  WriteText(dir / "sfm/sparse/0/images.txt", "5 1 0 0");
  EXPECT_THAT(error(), HasSubstr((dir / "sfm/sparse/0/images.txt").string()));
}

TEST(TriangulatePoints, ReusesAFinishedRun) {
  const TempDir dir;
  Scene scene = WriteSmallScene(dir / "scene");
  WriteFinishedRun(scene, dir / "sfm");
  const NoPrograms no_programs;
  EventRecorder events;
  EXPECT_EQ(TriangulatePoints(scene, kViews, {dir / "sfm"}, events.AsListener()).size(), 2u);
  EXPECT_THAT(events.warnings, IsEmpty());

  Scene moved = scene;
  moved.views[0].cam_from_world->translation().x() = 1;
  EXPECT_THAT(TriangulatePoints(moved, kViews, {dir / "sfm"}, events.AsListener()), IsEmpty());
  EXPECT_THAT(events.warnings, ElementsAre(HasSubstr("colmap program is not installed")));
  EXPECT_EQ(TriangulatePoints(scene, kViews, {dir / "sfm"}, events.AsListener()).size(), 2u)
      << "the old result still stands";

  events = {};
  WriteText(dir / "sfm/sparse/0/points3D.txt", "1 1 2");
  EXPECT_THAT(TriangulatePoints(scene, kViews, {dir / "sfm"}, events.AsListener()), IsEmpty());
  EXPECT_THAT(events.warnings, ElementsAre(AllOf(HasSubstr("points3D.txt"), HasSubstr("triangulated again")),
                                           HasSubstr("not installed")));
}

TEST(TriangulatePoints, ReusesAFinishedRunOfMovedImages) {
  const TempDir dir;
  WriteFinishedRun(WriteSmallScene(dir / "scene"), dir / "sfm");
  fs::remove_all(dir / "scene");
  const Scene moved = WriteSmallScene(dir / "moved");
  const NoPrograms no_programs;
  EventRecorder events;
  EXPECT_EQ(TriangulatePoints(moved, kViews, {dir / "sfm"}, events.AsListener()).size(), 2u);
  EXPECT_THAT(events.warnings, IsEmpty());
}

TEST(ReadModel, TurnsPosesBack) {
  const TempDir dir;
  const Scene scene = WriteSmallScene(dir / "scene");
  auto plan = PlanStaging(scene, kViews);
  plan[0].is_turned = true;
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.translation() = Eigen::Vector3d(.3, -.2, 4);
  const Intrinsics camera{CameraModel::kSimpleRadial, 4, 6, {7, 1.5, 3.25, .01}};
  const fs::path model = dir / "sfm" / "sparse" / "0";
  WriteColmapText(model, {{2, camera}}, {{8, plan[0].name, 2, turned}});
  WriteText(model / "points3D.txt", "");
  StageImages(scene, kViews, plan, dir / "sfm");
  const SceneView view = ReadModel(scene, kViews, plan, dir / "sfm", Silent()).views.at(kViews[0]);
  EXPECT_EQ(view.intrinsics.width, 6);
  EXPECT_EQ(view.intrinsics.height, 4);
  // A pixel (x, y) of the photo is at (height - y, x) of the turned one.
  const Eigen::Vector3d point(.5, .7, 3), in_photo = *view.cam_from_world * point, in_turned = turned * point;
  const auto pixel = [](const Intrinsics& k, const Eigen::Vector3d& p) {
    return Eigen::Vector2d(k.params[0] * p.x() / p.z() + k.params[1], k.params[0] * p.y() / p.z() + k.params[2]);
  };
  const Eigen::Vector2d at = pixel(view.intrinsics, in_photo), at_turned = pixel(camera, in_turned);
  EXPECT_NEAR(at_turned.x(), view.intrinsics.height - at.y(), 1e-9);
  EXPECT_NEAR(at_turned.y(), at.x(), 1e-9);
}

TEST(RememberedFailure, IsThatOfTheseInputs) {
  const TempDir dir;
  const Scene scene = WriteSmallScene(dir / "scene");
  const nlohmann::json inputs = DescribeInputs(scene, kViews);
  EXPECT_EQ(RememberedFailure(dir / "sfm", inputs), "");
  RememberFailure(dir / "sfm", inputs, "no overlap");
  EXPECT_EQ(RememberedFailure(dir / "sfm", inputs), "no overlap");
  EXPECT_EQ(RememberedFailure(dir / "sfm", DescribeInputs(scene, {0, 1})), "");
}

TEST(BeginAttempts, KeepsThoseOfTheSameInputs) {
  const TempDir dir;
  const Scene scene = WriteSmallScene(dir / "scene");
  const nlohmann::json inputs = DescribeInputs(scene, kViews);
  const fs::path done = AttemptsFolder(dir / "sfm") / "features0.db";
  BeginAttempts(dir / "sfm", inputs);
  WriteText(done, "");
  BeginAttempts(dir / "sfm", inputs);
  EXPECT_TRUE(fs::exists(done));
  BeginAttempts(dir / "sfm", DescribeInputs(scene, {0, 1}));
  EXPECT_FALSE(fs::exists(done));
}

}  // namespace
}  // namespace oraclegs
