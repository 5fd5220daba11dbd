#include "oraclegs/scene/read_colmap.h"

#include <cmath>

#include "oraclegs/core/files.h"
#include "oraclegs/scene/colmap_files.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/golden.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ReadColmapSceneTest : public ::testing::Test {
 protected:
  ReadColmapSceneTest() {
    WriteTinyModel(dir_ / "model");
    for (const char* name : {"a.png", "b.png", "c.png"}) WriteImage(dir_ / "images" / name);
  }
  Scene Read() { return ReadColmapScene(dir_ / "model", dir_ / "images", events_.AsListener()); }

  struct Folder : TempDir {
    fs::path operator/(const fs::path& p) const { return path() / p; }
  } dir_;
  EventRecorder events_;
};

TEST_F(ReadColmapSceneTest, SortsViewsAndMapsTracksToThem) {
  const Scene scene = Read();
  EXPECT_EQ(scene.format, SceneFormat::kColmap);
  ASSERT_EQ(scene.views.size(), 3u);
  EXPECT_EQ(scene.views[0].name, "a.png");
  EXPECT_EQ(scene.views[1].name, "b.png");
  EXPECT_EQ(scene.views[1].intrinsics.model, CameraModel::kOpenCv);
  EXPECT_EQ(scene.views[1].image_path, dir_ / "images/b.png");
  EXPECT_TRUE(scene.views[1].as_stored);
  EXPECT_EQ(scene.views[1].cam_from_world->translation(), Eigen::Vector3d(1, 2, 3));
  ASSERT_EQ(scene.points.size(), 1u);
  EXPECT_THAT(scene.points[0].views, ElementsAre(1, 2));
  EXPECT_THAT(scene.points[0].rgb, ElementsAre(10, 20, 255));
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0], HasSubstr("2 of 3 points are left out"));
}

TEST_F(ReadColmapSceneTest, LeavesOutViewsWithoutAnImage) {
  fs::remove(dir_ / "images/a.png");
  const Scene scene = Read();
  EXPECT_THAT(scene.missing_images, ElementsAre("a.png"));
  ASSERT_EQ(scene.views.size(), 2u);
  ASSERT_EQ(scene.points.size(), 1u);
  EXPECT_THAT(scene.points[0].views, ElementsAre(0, 1));
  EXPECT_THAT(events_.warnings.front(), HasSubstr("1 of 3 views have no image file"));
  EXPECT_THAT(events_.warnings.front(), HasSubstr(": a.png"));
}

TEST_F(ReadColmapSceneTest, RefusesAModelWithoutImages) {
  fs::remove_all(dir_ / "images");
  EXPECT_THAT(MessageOf<InputError>([&] { Read(); }), HasSubstr("none of its 3 views has an image file"));
}

TEST_F(ReadColmapSceneTest, NamesMissingFiles) {
  fs::remove(dir_ / "model/points3D.bin");
  EXPECT_TRUE(Read().points.empty());
  EXPECT_THAT(events_.warnings.back(), HasSubstr("no points3D"));
  fs::remove(dir_ / "model/cameras.bin");
  EXPECT_FALSE(IsColmapModel(dir_ / "model"));
  EXPECT_THAT(MessageOf<InputError>([&] { Read(); }), HasSubstr("neither cameras.bin nor cameras.txt"));
}

TEST_F(ReadColmapSceneTest, NamesTruncatedFiles) {
  WriteText(dir_ / "model/images.bin", TinyImagesBin().substr(0, 150));
  EXPECT_THAT(MessageOf<InputError>([&] { Read(); }), HasSubstr("images.bin: "));
}

TEST_F(ReadColmapSceneTest, RefusesContradictoryImages) {
  const auto with_images = [&](const char* text) {
    fs::remove(dir_ / "model/images.bin");
    WriteText(dir_ / "model/images.txt", text);
    return MessageOf<InputError>([&] { Read(); });
  };
  EXPECT_THAT(with_images("1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 0 0 0 1 a.png\n\n"), HasSubstr("'a.png' twice"));
  EXPECT_THAT(with_images("1 1 0 0 0 0 0 0 1 a.png\n\n1 1 0 0 0 0 0 0 1 b.png\n\n"), HasSubstr("image id 1"));
  EXPECT_THAT(with_images("1 1 0 0 0 0 0 0 2 a.png\n\n"), HasSubstr("cameras.bin: lacks camera 2"));
  EXPECT_THAT(with_images("# none\n"), HasSubstr("none of its 0 views"));
}

TEST_F(ReadColmapSceneTest, KeepsNamesInsideTheFolder) {
  fs::remove(dir_ / "model/images.bin");
  WriteText(dir_ / "model/images.txt", "1 1 0 0 0 0 0 0 1 ../images/a.png\n\n");
  const Scene scene = Read();
  ASSERT_EQ(scene.views.size(), 1u);
  EXPECT_EQ(scene.views[0].name, "images/a.png");
  EXPECT_TRUE(fs::exists(scene.views[0].image_path));
}

TEST_F(ReadColmapSceneTest, GivesPointsWithoutTracksTheViewsTheyFallInto) {
  fs::remove(dir_ / "model/points3D.bin");
  WriteText(dir_ / "model/points3D.txt", "1 0 0 9 1 2 3 0\n2 0 0 -9 1 2 3 0\n3 0 0 9 4 5 6 0 9 0\n");
  const Scene scene = Read();
  ASSERT_EQ(scene.points.size(), 2u);
  EXPECT_THAT(scene.points[0].views, ElementsAre(0, 1, 2));
  EXPECT_THAT(scene.points[1].views, ElementsAre(0));  // its track says so
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("2 of 3 points have no track")));
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("1 of 3 points are left out")));
}

TEST_F(ReadColmapSceneTest, ReadsNamesOfOtherSystems) {
  fs::rename(dir_ / "images/a.png", dir_ / "images/A.PNG");
  fs::create_directories(dir_ / "images/sub");
  fs::rename(dir_ / "images/b.png", dir_ / "images/sub/b.png");
  fs::remove(dir_ / "model/images.bin");
  WriteText(dir_ / "model/images.txt",
            "9 1 0 0 0 0 0 0 1 a.png\n\n3 1 0 0 0 0 0 1 1 sub\\b.png\n\n4 1 0 0 0 0 0 2 1 c.png\n\n");
  const Scene scene = Read();
  ASSERT_EQ(scene.views.size(), 3u);
  EXPECT_EQ(scene.views[0].name, "A.PNG");
  EXPECT_EQ(scene.views[2].name, "sub/b.png");
  EXPECT_THAT(scene.points.at(0).views, ElementsAre(1, 2));  // tracks follow the names
  EXPECT_THAT(events_.notes, ::testing::Contains(HasSubstr("2 of 3 paths")));
}

TEST_F(ReadColmapSceneTest, ReadsWrittenText) {
  ColmapCameras cameras;
  cameras[3] = {CameraModel::kOpenCv, 6, 4, {5.1, 5.2, 1.0 / 3, 2, 0.1, -0.2, 1e-17, 0}};
  ColmapImage image{.id = 12, .name = "sub/a.png", .camera_id = 3};
  image.cam_from_world.linear() =
      Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();  // w is small, its sign free
  image.cam_from_world.translation() = Eigen::Vector3d(0.1, -1e-9, 1e6);
  WriteColmapText(dir_ / "written", cameras, {image});

  WriteImage(dir_ / "images/sub/a.png");
  const Scene scene = ReadColmapScene(dir_ / "written", dir_ / "images", events_.AsListener());
  ASSERT_EQ(scene.views.size(), 1u);
  EXPECT_EQ(scene.views[0].name, "sub/a.png");
  EXPECT_EQ(scene.views[0].intrinsics.params, cameras[3].params);
  EXPECT_EQ(scene.views[0].cam_from_world->translation(), image.cam_from_world.translation());
  EXPECT_TRUE(scene.views[0].cam_from_world->linear().isApprox(image.cam_from_world.linear(), 1e-14));
  EXPECT_TRUE(scene.points.empty());
  EXPECT_TRUE(events_.warnings.empty());

  image.name = "a photo.png";
  EXPECT_THAT(MessageOf<InputError>([&] { WriteColmapText(dir_ / "bad", cameras, {image}); }),
              HasSubstr("'a photo.png'"));
}

TEST_F(ReadColmapSceneTest, ReadsWrittenTracks) {
  const ColmapCameras cameras = {{1, {CameraModel::kPinhole, 6, 4, {5, 5, 3, 2}}}};
  const std::vector<ColmapImage> images = {{1, "a.png", 1}, {2, "b.png", 1}};
  const std::vector<ColmapTrack> points = {{{0.5, -1.25, 3}, {10, 20, 255}, {{1, {1.5, 2.5}}, {2, {3.25, 0.5}}}},
                                           {{1, 2, 4}, {1, 2, 3}, {{2, {5, 3}}, {1, {0.5, 0.5}}}}};
  WriteColmapText(dir_ / "tracks", cameras, images, points);
  const std::string text = ReadFile(dir_ / "tracks/images.txt");
  EXPECT_THAT(text, HasSubstr("a.png\n1.5 2.5 1 0.5 0.5 2\n"));
  EXPECT_THAT(text, HasSubstr("b.png\n3.25 0.5 1 5 3 2\n"));
  EXPECT_THAT(ReadFile(dir_ / "tracks/points3D.txt"),
              HasSubstr("\n1 0.5 -1.25 3 10 20 255 0 1 0 2 0\n2 1 2 4 1 2 3 0 2 1 1 1\n"));
  WriteImage(dir_ / "images/a.png");
  WriteImage(dir_ / "images/b.png");
  const Scene scene = ReadColmapScene(dir_ / "tracks", dir_ / "images", events_.AsListener());
  ASSERT_EQ(scene.points.size(), 2u);
  EXPECT_EQ(scene.points[0].xyz, points[0].xyz);
  EXPECT_EQ(scene.points[0].rgb, points[0].rgb);
  EXPECT_EQ(scene.points[1].views, (std::vector<int>{0, 1}));
}

/// A model that COLMAP 4.2 wrote, with rigs and frames beside what older versions write.
TEST(ReadColmapModel, ReadsModelsOfColmap4) {
  for (const fs::path& model : {GoldenDir() / "colmap4", GoldenDir() / "colmap4" / "text"}) {
    const ColmapCameras cameras = ReadColmapCameras(model);
    ASSERT_EQ(cameras.size(), 2u) << model;
    EXPECT_THAT(cameras.at(1).params, ElementsAre(90, 50, 40, .01));
    EXPECT_EQ(cameras.at(2).model, CameraModel::kOpenCv);
    const std::vector<ColmapImage> images = ReadColmapImages(model);
    ASSERT_EQ(images.size(), 3u) << model;
    EXPECT_EQ(images[1].name, "sub/b.jpg");
    EXPECT_EQ(images[2].id, 5u);
    EXPECT_EQ(images[2].camera_id, 2u);
    EXPECT_EQ(images[2].cam_from_world.translation(), Eigen::Vector3d(-1, .2, .04));
    const std::vector<ColmapPoint> points = ReadColmapPoints(model);
    ASSERT_EQ(points.size(), 2u) << model;
    EXPECT_THAT(points[1].image_ids, ElementsAre(1, 2, 5));
  }
}

}  // namespace
}  // namespace oraclegs
