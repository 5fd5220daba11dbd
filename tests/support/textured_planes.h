#pragma once
// Images of known truth for tests of structure from motion: a wall z = kWallDepth with a shelf z = kShelfDepth in
// front of a part of it, both covered with noise, seen by cameras along a line.

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>

#include "oraclegs/image/codecs.h"
#include "oraclegs/image/image.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

inline constexpr double kWallDepth = 4, kShelfDepth = 3;
inline constexpr int kPlanesWidth = 256, kPlanesHeight = 192;
inline constexpr double kPlanesFocal = 240;

inline double PlaneNoise(double u, double v, uint32_t seed) {
  const auto at = [&](int64_t i, int64_t j) {
    uint32_t h = static_cast<uint32_t>(i) * 0x85EBCA6Bu ^ static_cast<uint32_t>(j) * 0xC2B2AE35u ^ seed * 0x9E3779B1u;
    h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12)) * 0x297A2D39u;
    return ((h ^ (h >> 15)) & 0xFFFF) / 65535.0;
  };
  const double i = std::floor(u), j = std::floor(v), a = u - i, b = v - j;
  const auto x = static_cast<int64_t>(i), y = static_cast<int64_t>(j);
  return (at(x, y) * (1 - a) + at(x + 1, y) * a) * (1 - b) + (at(x, y + 1) * (1 - a) + at(x + 1, y + 1) * a) * b;
}

/// Writes DIR/images/0.png ... and returns the posed scene. `enlarged`: how many times kPlanesWidth an image is wide.
inline Scene WriteTexturedPlanes(const std::filesystem::path& dir, int views, int enlarged = 1) {
  const int width = kPlanesWidth * enlarged, height = kPlanesHeight * enlarged;
  const double focal = kPlanesFocal * enlarged;
  Scene scene;
  scene.root = dir;
  scene.format = SceneFormat::kTransforms;
  for (int v = 0; v < views; ++v) {
    const double camera_x = .35 * v - .7;
    const double turn = .03 * (v - 2);  // radians about y
    const double s = std::sin(turn), c = std::cos(turn);
    Eigen::Matrix3d rotation;  // cam from world
    rotation << c, 0, s, 0, 1, 0, -s, 0, c;
    SceneView view;
    view.name = std::to_string(v) + ".png";
    view.image_path = dir / "images" / view.name;
    view.intrinsics = {CameraModel::kPinhole, width, height, {focal, focal, width / 2., height / 2.}};
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = rotation;
    pose.translation() = -rotation * Eigen::Vector3d(camera_x, 0, 0);
    view.cam_from_world = pose;

    Image8 image{width, height, 3, {}};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const Eigen::Vector3d ray =
            rotation.transpose() * Eigen::Vector3d((x + .5 - width / 2.) / focal, (y + .5 - height / 2.) / focal, 1);
        Eigen::Vector3d at = Eigen::Vector3d(camera_x, 0, 0) + ray * (kShelfDepth / ray.z());
        const bool shelf = std::abs(at.x()) < .7 && at.y() > -.4;
        if (!shelf) at = Eigen::Vector3d(camera_x, 0, 0) + ray * (kWallDepth / ray.z());
        for (uint32_t k = 0; k < 3; ++k) {
          const uint32_t seed = (shelf ? 1 : 5) + (k == 0 ? 0 : 40 + k);
          const double n =
              .55 * PlaneNoise(at.x() * 11, at.y() * 11, seed) + .45 * PlaneNoise(at.x() * 25, at.y() * 25, 9);
          image.data.push_back(static_cast<uint8_t>(255 * n));
        }
      }
    }
    std::filesystem::create_directories(view.image_path.parent_path());
    WritePng(view.image_path, image);
    scene.views.push_back(std::move(view));
  }
  return scene;
}

}  // namespace oraclegs
