#include "oraclegs/scene/spheres.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "oraclegs/camera/sphere_faces.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/scene/photo_folder.h"
#include "oraclegs/scene/split.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class SpheresTest : public ::testing::Test {
 protected:
  /// A photo whose file has `metadata` behind its pixels.
  void Add(const std::string& name, int width, int height, const std::string& metadata = "") {
    SceneView view;
    view.name = name;
    view.image_path = dir_ / name;
    view.intrinsics.width = width, view.intrinsics.height = height;
    WriteImage(view.image_path, width, height);
    std::ofstream(view.image_path, std::ios::app) << metadata;
    scene_.root = dir_.path();
    scene_.views.push_back(std::move(view));
  }
  /// A posed photo of an equidistant lens whose image circle ends 95 degrees from the axis, black beyond.
  void AddFisheye(const std::string& name, double focal = 60) {
    SceneView view;
    view.name = name;
    view.image_path = dir_ / name;
    view.intrinsics = {CameraModel::kOpenCvFisheye, 240, 240, {focal, focal, 120, 120, 0, 0, 0, 0}};
    view.cam_from_world = Eigen::Isometry3d(Eigen::AngleAxisd(.3, Eigen::Vector3d(2, 1, 3).normalized()));
    view.cam_from_world->pretranslate(Eigen::Vector3d(.3, .1, -.2));
    Image8 image{240, 240, 3, {}};
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 240; ++x) {
        const bool lit = std::hypot(x - 119.5, y - 119.5) < focal * 95 * std::numbers::pi / 180;
        image.data.insert(image.data.end(), 3, lit ? 130 : 4);
      }
    }
    WritePng(view.image_path, image);
    scene_.root = dir_.path();
    scene_.format = SceneFormat::kColmap;
    scene_.views.push_back(std::move(view));
  }
  std::vector<std::string> Spheres() const {
    std::vector<std::string> names;
    for (const SceneView& view : scene_.views) {
      if (view.is_sphere) names.push_back(view.name);
    }
    return names;
  }
  void TakeAll() {
    MarkSpheres(SphereChoice::kAll, &scene_);
    TakeFaces(dir_ / "faces", events_.AsListener(), &scene_);
  }
  std::vector<std::string> Names() const { return NamesAt(scene_, AllViews(scene_)); }

  TempDir dir_;
  Scene scene_;
  EventRecorder events_;
};

TEST_F(SpheresTest, AreMarkedByMetadataAndSize) {
  const std::string sphere = "GPano:ProjectionType=\"equirectangular\"";
  Add("a.png", 20, 10, sphere);
  Add("crop.png", 20, 10, sphere + " GPano:CroppedAreaTopPixels=\"7\"");
  Add("odd.png", 21, 10, sphere);
  Add("plain.png", 20, 10);
  Add("photo.png", 12, 10);
  MarkSpheres(SphereChoice::kMarked, &scene_);
  EXPECT_THAT(Spheres(), ElementsAre("a.png"));
  MarkSpheres(SphereChoice::kAll, &scene_);
  EXPECT_THAT(Spheres(), ElementsAre("a.png", "crop.png", "plain.png"));
  std::filesystem::remove(dir_ / "plain.png");
  MarkSpheres(SphereChoice::kAll, &scene_);
  EXPECT_THAT(Spheres(), ElementsAre("a.png", "crop.png"));
}

TEST_F(SpheresTest, GiveWayToSixViews) {
  Add("in/a.png", 200, 100);
  Add("b.png", 12, 10);
  Add("in/a_up.png", 12, 10);
  scene_.views[0].mask_path = dir_ / "masks" / "a.png";
  scene_.views[0].mask_white = 7;
  scene_.views[0].depth_path = scene_.views[0].confidence_path = dir_ / "depth.png";
  scene_.views[0].gps = GpsPosition{1, 2, 3};
  TakeAll();
  EXPECT_THAT(Names(), ElementsAre("b.png", "in/a_back.png", "in/a_down.png", "in/a_front.png", "in/a_left.png",
                                   "in/a_right.png", "in/a_up-2.png", "in/a_up.png"));
  const SceneView& down = scene_.views[2];
  EXPECT_FALSE(down.is_sphere);
  ASSERT_TRUE(down.sphere);
  EXPECT_EQ(down.sphere->name, "in/a.png");
  EXPECT_EQ(down.sphere->face, 5);
  EXPECT_EQ(down.sphere->mask_white, 7);
  EXPECT_EQ(down.image_path, dir_ / "faces" / "images" / "in/a_down.png");
  EXPECT_EQ(down.mask_path, dir_ / "faces" / "masks" / "in/a_down.png.png");
  EXPECT_TRUE(down.depth_path.empty() && down.confidence_path.empty());
  EXPECT_EQ(down.mask_white, 255);
  EXPECT_EQ(down.focal_prior, FaceIntrinsics(200).fx());
  EXPECT_EQ(down.intrinsics.width, FaceIntrinsics(200).width);
  EXPECT_TRUE(down.intrinsics.params.empty());
  EXPECT_FALSE(scene_.views[0].sphere);
  EXPECT_EQ(
      std::count_if(scene_.views.begin(), scene_.views.end(), [](const SceneView& v) { return v.gps.has_value(); }), 1);
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("1 spherical photo is cut into 6 views each, 100 x 100 degrees")));
}

TEST_F(SpheresTest, FacesHaveTheirSpheresPose) {
  Add("a.png", 200, 100);
  scene_.format = SceneFormat::kTransforms;
  Eigen::Isometry3d pose(Eigen::AngleAxisd(.7, Eigen::Vector3d(1, 2, 3).normalized()));
  pose.pretranslate(Eigen::Vector3d(.1, .2, .3));
  scene_.views[0].cam_from_world = pose;
  scene_.views[0].is_sphere = true;
  EXPECT_THAT(MessageOf<InputError>([&] { RequireNoSpheres(scene_); }),
              AllOf(HasSubstr("a.png: is a spherical photo"), HasSubstr("oraclegs reconstruct")));
  TakeFaces(dir_ / "faces", Silent(), &scene_);
  EXPECT_NO_THROW(RequireNoSpheres(scene_));
  const Eigen::Vector3d point(3, -2, 5), in_sphere = pose * point;
  int seen = 0;
  for (const SceneView& view : scene_.views) {
    const Intrinsics& camera = view.intrinsics;
    camera.Check(view.name);
    EXPECT_EQ(view.focal_prior, 0);
    const Eigen::Vector3d in_face = *view.cam_from_world * point;
    EXPECT_NEAR(in_face.norm(), in_sphere.norm(), 1e-12) << "one center";
    if (in_face.z() <= 0) continue;
    const Eigen::Vector3d ray((in_face.x() / in_face.z()), in_face.y() / in_face.z(), 1);
    seen += std::max(std::abs(ray.x()), std::abs(ray.y())) * camera.fx() < camera.width / 2.;
    const Eigen::Matrix3d& turn = SphereFaces()[static_cast<size_t>(view.sphere->face)].face_from_sphere;
    EXPECT_NEAR((SpherePixel(turn.transpose() * ray, 200, 100) - SpherePixel(in_sphere, 200, 100)).norm(), 0, 1e-9);
  }
  EXPECT_GE(seen, 1);
}

TEST_F(SpheresTest, OfFisheyePhotosAreTheFacesThatTheyFill) {
  AddFisheye("b.png");
  AddFisheye("a.png", 300);
  AddFisheye("c.png", 300);
  scene_.views[0].as_stored = true;
  const SceneView photo = scene_.views[0];
  const auto at = [&](double x, double y, double z) {
    return photo.cam_from_world->inverse() * Eigen::Vector3d(x, y, z);
  };
  scene_.points = {{at(.3, .1, 2), {}, {0, 1}},
                   {at(3, 0, .5), {}, {0}},
                   {at(0, 0, 9), {}, {1, 2}},
                   {at(-2, 1.9, .1), {}, {0, 2}},
                   {at(0, 0, -3), {}, {0}}};
  EXPECT_THAT(
      MessageOf<InputError>([&] { RequireNoSpheres(scene_); }),
      AllOf(HasSubstr("b.png: is a fisheye photo of more than 160 degrees"), HasSubstr("oraclegs reconstruct")));
  TakeFaces(dir_ / "faces", events_.AsListener(), &scene_);
  EXPECT_NO_THROW(RequireNoSpheres(scene_));
  EXPECT_THAT(Names(),
              ElementsAre("a.png", "b_down.png", "b_front.png", "b_left.png", "b_right.png", "b_up.png", "c.png"));
  EXPECT_FALSE(scene_.views[0].sphere) << "23 degrees are no wide lens";
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("1 fisheye photo is cut into 5 views, of up to 100 x 100 degrees: "
                                                   "they show 18")));
  for (size_t i = 1; i < 6; ++i) {
    const SceneView& view = scene_.views[i];
    ASSERT_TRUE(view.sphere && view.sphere->lens);
    EXPECT_EQ(view.sphere->lens->intrinsics.params, photo.intrinsics.params);
    EXPECT_NEAR(view.sphere->lens->reach * 180 / std::numbers::pi, 94, .7) << "less a rim, and not to the corners";
    EXPECT_TRUE(view.sphere->as_stored);
    EXPECT_EQ(view.mask_path, dir_ / "faces/masks" / (view.name + ".png"));
    const Eigen::Matrix3d& turn = SphereFaces()[static_cast<size_t>(view.sphere->face)].face_from_sphere;
    EXPECT_LT((view.cam_from_world->matrix() - (Eigen::Isometry3d(turn) * *photo.cam_from_world).matrix()).norm(),
              1e-15);
  }
  ASSERT_EQ(scene_.points.size(), 4u) << "without the one that no view shows";
  EXPECT_THAT(scene_.points[0].views, ElementsAre(0, 2)) << "the flat photo has another number now";
  EXPECT_THAT(scene_.points[1].views, ElementsAre(4)) << "80 degrees to the right";
  EXPECT_THAT(scene_.points[2].views, ElementsAre(0, 6));
  EXPECT_THAT(scene_.points[3].views, ElementsAre(1, 3, 6)) << "down and left";

  SplitOptions options;
  options.test_views = "b_up";
  EXPECT_THAT(SplitViews(scene_, options).test, ElementsAre(1, 2, 3, 4, 5));
}

TEST_F(SpheresTest, OfAFisheyePhotoThatCannotBeReadReachAsFarAsItsModel) {
  AddFisheye("a.png"), AddFisheye("b.png");
  for (const char* name : {"a.png", "b.png"}) {
    std::filesystem::resize_file(dir_ / name, std::filesystem::file_size(dir_ / name) / 2);
  }
  TakeFaces(dir_ / "faces", Silent(), &scene_);
  EXPECT_NEAR(scene_.views[0].sphere->lens->reach, 2 * std::sqrt(2.), 1e-9);
}

TEST_F(SpheresTest, RefusesOthersThanWholeOnesAndTooMany) {
  Add("a.png", 30, 10);
  scene_.views[0].is_sphere = true;
  EXPECT_THAT(MessageOf<InputError>([&] { TakeFaces(dir_ / "faces", Silent(), &scene_); }),
              HasSubstr("a.png: is 30 x 10, but an equirectangular photo is twice as wide as high"));
  scene_.views.clear();
  Add("b.png", 20, 10);
  scene_.views[0].is_sphere = true;
  while (static_cast<int>(scene_.views.size()) * kSphereFaces <= kMaxPhotos) {
    scene_.views.push_back(scene_.views[0]);
    scene_.views.back().name = std::to_string(scene_.views.size()) + ".png";
  }
  Scene copy = scene_;
  EXPECT_THAT(MessageOf<InputError>([&] { TakeFaces(dir_ / "faces", Silent(), &copy); }),
              HasSubstr("84 spherical photos are cut into 6 views each, and at most 500"));
  scene_.format = SceneFormat::kTransforms;
  EXPECT_NO_THROW(TakeFaces(dir_ / "faces", Silent(), &scene_)) << "with poses any number";
}

TEST_F(SpheresTest, TrainOrTestAsAWhole) {
  for (const char* name : {"1.png", "2.png", "3.png", "4.png", "5.png"}) Add(name, 200, 100);
  Add("6.png", 12, 10);
  TakeAll();
  const auto photos = ByPhoto(scene_, AllViews(scene_));
  ASSERT_THAT(photos, SizeIs(6));
  EXPECT_THAT(photos[2], ElementsAre(12, 13, 14, 15, 16, 17));
  EXPECT_THAT(photos[5], ElementsAre(30));

  SplitOptions options;
  options.test_every = 3;
  Split split = SplitViews(scene_, options);
  EXPECT_THAT(split.test, ElementsAre(0, 1, 2, 3, 4, 5, 18, 19, 20, 21, 22, 23)) << "1 and 4";
  EXPECT_THAT(split.train, SizeIs(19));
  options.views = 2;
  split = SplitViews(scene_, options);
  EXPECT_THAT(split.train, ElementsAre(6, 7, 8, 9, 10, 11, 30)) << "2 and 6";
  options.views = 5;
  EXPECT_THAT(MessageOf<InputError>([&] { SplitViews(scene_, options); }), HasSubstr("only 4 are left"));

  options = {};
  options.test_views = "3_up,1.png";
  split = SplitViews(scene_, options);
  EXPECT_THAT(split.test, ElementsAre(0, 1, 2, 3, 4, 5, 12, 13, 14, 15, 16, 17)) << "a face stands for all";
  options.train_views = "2";
  split = SplitViews(scene_, options);
  EXPECT_THAT(split.train, ElementsAre(6, 7, 8, 9, 10, 11));
  scene_.views.resize(6);
  EXPECT_THAT(MessageOf<InputError>([&] { SplitViews(scene_, {}); }), HasSubstr("one photo is not enough"));
}

}  // namespace
}  // namespace oraclegs
