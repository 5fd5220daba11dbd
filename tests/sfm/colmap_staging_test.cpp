#include "oraclegs/sfm/colmap_staging.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

TEST(PlanStaging, GivesTheFacesOfASphereOneNameAndAsManyCameras) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 4);
  for (int v = 0; v < 4; ++v) {  // two faces each of "a b.jpg" and "a_b.tif"
    SceneView& view = scene.views[static_cast<size_t>(v)];
    view.sphere = SphereSource{v < 2 ? "a b.jpg" : "a_b.tif", {}, {}, 255, v % 2, {}};
  }
  const auto plan = PlanStaging(scene, {0, 1, 2, 3});
  EXPECT_EQ(plan[0].name, "camera0/a_b.png");
  EXPECT_EQ(plan[1].name, "camera1/a_b.png");
  EXPECT_EQ(plan[2].name, "camera0/2-a_b.png");
  EXPECT_EQ(plan[3].name, "camera1/2-a_b.png");
}

TEST(PlanStaging, GroupsViewsByIntrinsics) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 4);
  scene.views[0].name = "a b.png";
  scene.views[1].name = "a_b.png";
  scene.views[2].name = "../left/c";
  scene.views[3].intrinsics.params[0] += 1;
  const auto plan = PlanStaging(scene, {0, 1, 2, 3});
  std::set<std::string> names;
  for (const StagedView& staged : plan) {
    names.insert(staged.name);
    EXPECT_EQ(staged.name.find(' '), std::string::npos);
    EXPECT_FALSE(staged.is_copy);
  }
  EXPECT_EQ(names.size(), 4u);
  EXPECT_EQ(plan[0].name, "camera0/a_b.png");
  EXPECT_EQ(plan[2].name, "camera0/_.._left_c.png");
  EXPECT_EQ(plan[1].camera, 0);
  EXPECT_EQ(plan[3].camera, 1);
}

TEST(PlanStaging, CopiesRotatedImagesUpright) {
  const TempDir dir;
  Scene scene;
  SceneView view;
  view.name = "a.jpg";
  view.image_path = dir / view.name;
  WriteText(view.image_path, WithOrientation(EncodeJpeg(SmoothImage(24, 16, 3)), 3));
  scene.views = {view};
  EXPECT_TRUE(PlanStaging(scene, {0})[0].is_copy) << "a plain photo is used upright";
  scene.views[0].intrinsics = {CameraModel::kSimplePinhole, 24, 16, {20, 12, 8}};
  EXPECT_TRUE(PlanStaging(scene, {0})[0].is_copy);
  scene.views[0].as_stored = true;
  EXPECT_FALSE(PlanStaging(scene, {0})[0].is_copy) << "colmap's poses are of the stored pixels";
  WriteText(view.image_path, WithOrientation(EncodeJpeg(SmoothImage(16, 24, 3)), 6));
  EXPECT_TRUE(PlanStaging(scene, {0})[0].is_copy) << "only the upright image has the size of the camera";
}

TEST(PlanStaging, GroupsPhotosByCameraAndFocalLength) {
  const TempDir dir;
  Scene scene;
  const auto add = [&](const char* name, int width, int height, double focal, const char* camera) {
    SceneView view;
    view.name = name;
    view.image_path = dir / name;
    view.focal_prior = focal;
    view.camera = camera;
    WritePng(view.image_path, SmoothImage(width, height, 3));
    scene.views.push_back(view);
  };
  add("a.png", 24, 16, 20, "Phone");
  add("b.png", 24, 16, 20, "Phone");
  add("c.png", 16, 24, 20, "Phone");  // upright
  add("d.png", 24, 16, 30, "Phone");  // the other lens
  add("e.png", 24, 16, 20, "Camera");
  add("f.png", 24, 16, 0, "");
  std::vector<int> cameras;
  for (const StagedView& staged : PlanStaging(scene, {0, 1, 2, 3, 4, 5})) cameras.push_back(staged.camera);
  EXPECT_EQ(cameras, (std::vector<int>{0, 0, 1, 2, 3, 4}));
}

/// Photos of 24 x 16, or 16 x 24 where a name has a "p" in it, of one phone; "lost" ones have no EXIF.
Scene WritePhonePhotos(const fs::path& dir, const std::vector<std::string>& names) {
  Scene scene;
  for (const std::string& name : names) {
    SceneView view;
    view.name = name;
    view.image_path = dir / name;
    const bool portrait = name[0] == 'p', lost = name.find("lost") != std::string::npos;
    view.camera = lost ? "" : "Phone";
    view.focal_prior = lost ? 0 : 20;
    WritePng(view.image_path, SmoothImage(portrait ? 16 : 24, portrait ? 24 : 16, 3));
    scene.views.push_back(view);
  }
  return scene;
}

TEST(PlanStaging, TurnsTheFewerPhotosOfOneDevice) {
  const TempDir dir;
  const Scene scene = WritePhonePhotos(dir.path(), {"p1.png", "l2.png", "p3.png", "p4-lost.png", "l5-lost.png"});
  const auto plan = PlanStaging(scene, {0, 1, 2, 3, 4}, Upright::kTurn);
  for (size_t i = 0; i < plan.size(); ++i) {
    EXPECT_EQ(plan[i].camera, 0) << i;
    EXPECT_EQ(plan[i].is_turned, i == 1 || i == 4) << i;
  }
  EXPECT_EQ(plan[1].name, "camera0/l2.png.jpg");
  for (const StagedView& staged : PlanStaging(scene, {0, 1, 2, 3, 4})) EXPECT_FALSE(staged.is_turned);
}

TEST(PlanStaging, KeepsPhotosWithoutExifApartWhereTwoCamerasFit) {
  const TempDir dir;
  Scene scene = WritePhonePhotos(dir.path(), {"l1.png", "l2.png", "l3-lost.png"});
  EXPECT_EQ(PlanStaging(scene, {0, 1, 2}, Upright::kTurn)[2].camera, 0);
  scene.views[1].focal_prior = 40;
  EXPECT_EQ(PlanStaging(scene, {0, 1, 2}, Upright::kTurn)[2].camera, 2);
}

TEST(StageImages, TurnsPhotoAndMaskClockwise) {
  const TempDir dir;
  Scene scene = WritePhonePhotos(dir.path(), {"p1.png", "p2.png", "l3.png"});
  Image8 mask{24, 16, 1, std::vector<uint8_t>(24 * 16, 255)};
  mask.data[0] = 0;  // of the corner at the upper left
  scene.views[2].mask_path = dir / "mask.png";
  WritePng(scene.views[2].mask_path, mask);
  const auto plan = PlanStaging(scene, {0, 1, 2}, Upright::kTurn);
  StageImages(scene, {0, 1, 2}, plan, dir / "sfm");
  const Image8 photo = ReadImage(scene.views[2].image_path);
  const Image8 turned = ReadImage(dir / "sfm" / "images" / plan[2].name);
  ASSERT_EQ(turned.width, 16);
  ASSERT_EQ(turned.height, 24);
  EXPECT_NEAR(turned.data[15 * 3], photo.data[0], 12) << "the upper left corner is at the upper right now";
  EXPECT_NEAR(turned.data[(size_t{23} * 16 + 15) * 3], photo.data[23 * 3], 12);
  const Image8 turned_mask = ReadImage(dir / "sfm" / "masks" / (plan[2].name + ".png"));
  ASSERT_EQ(turned_mask.width, 16);
  EXPECT_EQ(turned_mask.data[15 * static_cast<size_t>(turned_mask.channels)], 0);
  EXPECT_EQ(turned_mask.data[0], 255);
}

TEST(StageImages, CopiesWhatColmapDoesNotRead) {
  const TempDir dir;
  Scene scene;
  SceneView view;
  view.name = "a.heic";
  view.image_path = dir / view.name;
  WriteText(view.image_path, EncodeHeif(SmoothImage(64, 48, 3)));
  scene.views = {view};
  const auto plan = PlanStaging(scene, {0});
  EXPECT_TRUE(plan[0].is_copy);
  EXPECT_EQ(plan[0].name, "camera0/a.heic.jpg");
  EXPECT_FALSE(StageImages(scene, {0}, plan, dir / "sfm"));
  const std::string copy = ReadFile(dir / "sfm" / "images" / plan[0].name);
  EXPECT_TRUE(IsJpeg(copy));
  EXPECT_EQ(ReadImage(dir / "sfm" / "images" / plan[0].name).width, 64);
}

TEST(PlanStaging, NamesPhotosWithoutExtensionByContent) {
  const TempDir dir;
  Scene scene;
  for (const char* name : {"a", "b.dat"}) {
    SceneView view;
    view.name = name;
    view.image_path = dir / name;
    scene.views.push_back(view);
  }
  WriteText(dir / "a", EncodeJpeg(SmoothImage(64, 48, 3)));
  WritePng(dir / "b.dat", SmoothImage(64, 48, 3));
  const auto plan = PlanStaging(scene, {0, 1});
  EXPECT_EQ(plan[0].name, "camera0/a.jpg");
  EXPECT_EQ(plan[1].name, "camera0/b.dat.png");
}

TEST(StageImages, LinksImagesAndWritesMasks) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 3);
  WritePng(scene.views[1].image_path, {2, 1, 4, {9, 9, 9, 255, 9, 9, 9, 0}});
  scene.views[2].mask_path = dir / "mask.png";
  WritePng(scene.views[2].mask_path, {2, 1, 1, {127, 128}});
  const std::vector<int> views{0, 1, 2};
  const auto plan = PlanStaging(scene, views);
  EXPECT_TRUE(StageImages(scene, views, plan, dir / "sfm"));
  for (size_t i = 0; i < 3; ++i) {
    const fs::path link = dir / "sfm" / "images" / plan[i].name;
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_TRUE(fs::equivalent(link, scene.views[i].image_path));
  }
  const auto mask = [&](size_t i) { return dir / "sfm" / "masks" / (plan[i].name + ".png"); };
  EXPECT_FALSE(fs::exists(mask(0)));
  const Image8 from_alpha = ReadImage(mask(1)), from_file = ReadImage(mask(2));
  EXPECT_EQ(from_alpha.data[0], 255);
  EXPECT_EQ(from_alpha.data.back(), 0);
  EXPECT_EQ(from_file.data[0], 0);
  EXPECT_EQ(from_file.data.back(), 255);
}

TEST(StageImages, FitsMasksToThePhotosThatColmapSees) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 2);
  scene.views[0].mask_path = dir / "half.png";
  scene.views[1].mask_path = dir / "zero_and_one.png";
  scene.views[1].mask_white = 1;
  for (SceneView& view : scene.views) {
    WritePng(view.image_path, {4, 2, 3, std::vector<uint8_t>(24, 90)});
    view.intrinsics.width = 4;
    view.intrinsics.height = 2;
  }
  WritePng(scene.views[0].mask_path, {2, 1, 1, {0, 255}});
  WritePng(scene.views[1].mask_path, {4, 2, 1, {1, 0, 0, 0, 0, 0, 0, 1}});
  const auto plan = PlanStaging(scene, {0, 1});
  EXPECT_TRUE(StageImages(scene, {0, 1}, plan, dir / "sfm"));
  const auto kept = [&](size_t i) {
    const Image8 mask = ReadImage(dir / "sfm" / "masks" / (plan[i].name + ".png"));
    std::vector<int> values;
    for (size_t p = 0; p < mask.data.size(); p += static_cast<size_t>(mask.channels)) values.push_back(mask.data[p]);
    return values;
  };
  EXPECT_THAT(kept(0), ::testing::ElementsAre(0, 0, 255, 255, 0, 0, 255, 255));
  EXPECT_THAT(kept(1), ::testing::ElementsAre(255, 0, 0, 0, 0, 0, 0, 255));
}

TEST(StageImages, RefusesAMaskOfAnotherSize) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 1);
  WritePng(scene.views[0].image_path, {2, 1, 4, std::vector<uint8_t>(8, 0)});
  scene.views[0].mask_path = dir / "mask.png";
  WritePng(scene.views[0].mask_path, {3, 1, 1, {1, 2, 3}});
  EXPECT_THROW(StageImages(scene, {0}, PlanStaging(scene, {0}), dir / "sfm"), InputError);
}

TEST(DescribeInputs, ChangesWithPoseIntrinsicsAndFile) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 2);
  const auto before = DescribeInputs(scene, {0, 1});
  EXPECT_EQ(before, DescribeInputs(scene, {0, 1}));
  EXPECT_NE(before, DescribeInputs(scene, {0}));
  Scene moved = scene;
  moved.views[1].cam_from_world->translation().x() += 1e-9;
  EXPECT_NE(before, DescribeInputs(moved, {0, 1}));
  Scene zoomed = scene;
  zoomed.views[0].intrinsics.params[0] += 1e-9;
  EXPECT_NE(before, DescribeInputs(zoomed, {0, 1}));
  WritePng(scene.views[0].image_path, {1, 1, 3, {0, 0, 0}});
  EXPECT_NE(before, DescribeInputs(scene, {0, 1}));
}

}  // namespace
}  // namespace oraclegs
