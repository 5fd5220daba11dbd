#include "oraclegs/sfm/tie_spheres.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "oraclegs/camera/sphere_faces.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/scene/spheres.h"
#include "oraclegs/sfm/register_views.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

Eigen::Isometry3d Pose(const Eigen::Vector3d& turn, const Eigen::Vector3d& center) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  pose.translation() = -(pose.linear() * center);
  return pose;
}

Eigen::Vector3d CenterOf(const Eigen::Isometry3d& pose) { return pose.inverse().translation(); }

double DegreesBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / std::numbers::pi;
}

/// Faces of a sphere of this pose, each a little off, by numbers that differ.
std::vector<FoundFace> FacesOf(const Eigen::Isometry3d& sphere, double off) {
  std::vector<FoundFace> faces;
  for (int i = 0; i < kSphereFaces; ++i) {
    const Eigen::Vector3d error(std::sin(3. * i + 1), std::sin(5. * i + 2), std::sin(7. * i));
    const Eigen::Matrix3d& turn = SphereFaces()[static_cast<size_t>(i)].face_from_sphere;
    const Eigen::Isometry3d found = Eigen::Isometry3d(turn) * sphere;
    faces.push_back({turn, Pose(off * error + Eigen::Vector3d::UnitX() * 1e-9, off * error) * found});
  }
  return faces;
}

TEST(SpherePose, IsThatOfFacesThatAgree) {
  const Eigen::Isometry3d sphere = Pose({.3, -1.2, 2}, {4, 5, -6});
  const auto faces = FacesOf(sphere, 0);
  for (size_t count = 1; count <= faces.size(); ++count) {
    const Eigen::Isometry3d pose = SpherePose({faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(count)});
    EXPECT_NEAR((CenterOf(pose) - Eigen::Vector3d(4, 5, -6)).norm(), 0, 1e-7);
    EXPECT_NEAR(DegreesBetween(pose, sphere), 0, 1e-5);
    EXPECT_NEAR((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  }
}

TEST(SpherePose, IsHardlyMovedByAFaceFarOff) {
  const Eigen::Isometry3d sphere = Pose({.3, -1.2, 2}, {4, 5, -6});
  auto faces = FacesOf(sphere, .01);
  const Eigen::Isometry3d before = SpherePose(faces);
  EXPECT_LT((CenterOf(before) - Eigen::Vector3d(4, 5, -6)).norm(), .02);
  EXPECT_LT(DegreesBetween(before, sphere), 1);
  faces[2].cam_from_world = Pose({2, 1, 0}, {90, 80, 70});
  const Eigen::Isometry3d after = SpherePose(faces);
  EXPECT_LT((CenterOf(after) - Eigen::Vector3d(4, 5, -6)).norm(), .03) << "a mean would be 25 off";
  EXPECT_LT(DegreesBetween(after, sphere), 1.5);
}

TEST(SpherePose, BelievesTheFaceThatSawMore) {
  const Eigen::Isometry3d sphere = Pose({.3, -1.2, 2}, {4, 5, -6});
  auto faces = FacesOf(sphere, 0);
  faces.resize(2);
  faces[0].weight = 20;
  faces[0].cam_from_world = Pose({2, 1, 0}, {90, 80, 70});
  faces[1].weight = 300;
  const Eigen::Isometry3d pose = SpherePose(faces);
  EXPECT_LT((CenterOf(pose) - Eigen::Vector3d(4, 5, -6)).norm(), 1e-3);
  EXPECT_LT(DegreesBetween(pose, sphere), 1e-2);
}

constexpr double kRoomHalf = 4;

/// The gray of a ray from inside a room of noise: a cube around the origin.
uint8_t RoomAt(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  double nearest = 1e9;
  int wall = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double t = ((ray[axis] > 0 ? kRoomHalf : -kRoomHalf) - from[axis]) / ray[axis];
    if (t > 0 && t < nearest) nearest = t, wall = 2 * axis + (ray[axis] > 0);
  }
  const Eigen::Vector3d at = from + nearest * ray;
  const double u = at[(wall / 2 + 1) % 3], v = at[(wall / 2 + 2) % 3];
  if (wall == 2) return 90;  // up is a plain ceiling
  return static_cast<uint8_t>(255 * (.55 * PlaneNoise(u * 6, v * 6, static_cast<uint32_t>(wall + 1)) +
                                     .45 * PlaneNoise(u * 14, v * 14, static_cast<uint32_t>(wall + 9))));
}

Image8 PhotoFrom(const Eigen::Vector3d& from, int width) {
  Image8 image{width, width / 2, 3, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double longitude = ((x + .5) / width - .5) * 2 * std::numbers::pi,
                   latitude = ((y + .5) / image.height - .5) * std::numbers::pi;
      const Eigen::Vector3d ray(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                                std::cos(latitude) * std::cos(longitude));
      image.data.insert(image.data.end(), 3, RoomAt(from, ray));
    }
  }
  return image;
}

TEST(TieSpheres, AllFacesOfASphereShareItsCenter) {
  const TempDir dir;
  const std::vector<Eigen::Vector3d> centers{{-.9, .1, 0}, {-.3, -.2, .5}, {.3, .1, -.3}, {.9, 0, .2}};
  Scene scene;
  scene.root = dir.path();
  constexpr int kWidth = 480;
  std::vector<Image8> photos;
  for (size_t i = 0; i < centers.size(); ++i) {
    SceneView view;
    view.name = std::to_string(i) + ".png";
    view.image_path = dir / view.name;
    view.is_sphere = true;
    photos.push_back(PhotoFrom(centers[i], kWidth));
    WritePng(view.image_path, photos.back());
    scene.views.push_back(std::move(view));
  }
  TakeFaces(dir / "faces", Silent(), &scene);
  for (const SceneView& view : scene.views) {
    const Image8& photo = photos[static_cast<size_t>(std::stoi(view.sphere->name))];
    std::filesystem::create_directories(view.image_path.parent_path());
    WritePng(view.image_path,
             CutFace(photo, std::nullopt, SphereFaces()[static_cast<size_t>(view.sphere->face)].face_from_sphere,
                     FaceIntrinsics(kWidth), SphereFilter::kBicubic));
  }
  EventRecorder events;
  const Scene found = RegisterViews(scene, dir / "sfm", events.AsListener());
  ASSERT_EQ(found.views.size(), scene.views.size()) << "those of the plain ceiling, too";
  std::map<std::string, Eigen::Isometry3d> pose_of;
  for (const SceneView& view : found.views) {
    EXPECT_TRUE(view.intrinsics.IsPinhole());
    EXPECT_EQ(view.intrinsics.fx(), FaceIntrinsics(kWidth).fx());
    const Eigen::Matrix3d& turn = SphereFaces()[static_cast<size_t>(view.sphere->face)].face_from_sphere;
    const Eigen::Isometry3d sphere = Eigen::Isometry3d(turn.transpose()) * *view.cam_from_world;
    const Eigen::Isometry3d first = pose_of.emplace(view.sphere->name, sphere).first->second;
    EXPECT_NEAR((CenterOf(sphere) - CenterOf(first)).norm(), 0, 1e-9);
    EXPECT_NEAR(DegreesBetween(sphere, first), 0, 1e-5);
  }
  // In the frame of the first sphere and the unit of its distance to the last one.
  const Eigen::Isometry3d to_first = pose_of.at("0.png");
  const double unit = (centers[3] - centers[0]).norm() / (to_first * CenterOf(pose_of.at("3.png"))).norm();
  for (size_t i = 1; i < centers.size(); ++i) {
    const Eigen::Isometry3d& pose = pose_of.at(std::to_string(i) + ".png");
    const Eigen::Vector3d center = unit * (to_first * CenterOf(pose));
    EXPECT_LT((center - (centers[i] - centers[0])).norm(), .01 * (centers[3] - centers[0]).norm()) << i;
    EXPECT_LT(DegreesBetween(to_first, pose), .2) << "none is turned";
  }
  EXPECT_GT(found.points.size(), 100u);
  EXPECT_EQ(RegisterViews(scene, dir / "sfm", Silent()).points.size(), found.points.size()) << "a result is read again";
}

TEST(TieSpheres, DoesNothingWithoutSpheres) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 3);
  EXPECT_FALSE(TieSpheres(scene, {}, {}, dir / "sfm", Silent()));
}

}  // namespace
}  // namespace oraclegs
