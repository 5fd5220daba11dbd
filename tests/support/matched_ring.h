#pragma once
// Cameras of known truth with matches between their images: a ring of cameras that look at a cloud of points, with
// pixels off by up to a third of a pixel.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "oraclegs/camera/distortion_models.h"
#include "oraclegs/sfm/match_fit.h"

namespace oraclegs {

struct MatchedRing {
  std::vector<Intrinsics> intrinsics;
  std::vector<Eigen::Isometry3d> cams_from_world;
  std::vector<ViewPair> pairs;
};

/// A number in [-1, 1) for each index.
inline double Wiggle(uint64_t index) {
  uint64_t h = (index + 1) * 0x9E3779B97F4A7C15u;
  h = (h ^ (h >> 31)) * 0xBF58476D1CE4E5B9u;
  h = (h ^ (h >> 29)) * 0x94D049BB133111EBu;
  return static_cast<double>((h ^ (h >> 32)) & 0xFFFFFFFF) / 2147483648.0 - 1;
}

/// Camera number i of a ring: unevenly spaced, of several heights and rolls, so that no two motions are alike.
inline Eigen::Isometry3d RingCamera(int i) {
  const double angle = .35 * i + .08 * std::sin(2.3 * i), height = .6 * std::sin(1.7 * i);
  const Eigen::Vector3d center(-4 * std::sin(angle), height, -4 * std::cos(angle));
  const Eigen::Vector3d forward = (Eigen::Vector3d(.3 * std::sin(i), .2 * std::cos(i), 0) - center).normalized();
  const Eigen::Vector3d down = Eigen::Vector3d(.1 * std::sin(3. * i), 1, 0);
  Eigen::Isometry3d world_from_cam = Eigen::Isometry3d::Identity();
  world_from_cam.linear().col(2) = forward;
  world_from_cam.linear().col(0) = down.cross(forward).normalized();
  world_from_cam.linear().col(1) = forward.cross(world_from_cam.linear().col(0));
  world_from_cam.translation() = center;
  return world_from_cam.inverse();
}

/// n cameras; each is matched with the next three, `matches` points a pair.
inline MatchedRing MakeMatchedRing(int n, int matches) {
  MatchedRing ring;
  const Intrinsics camera{CameraModel::kOpenCv, 800, 600, {700, 710, 410, 295, .05, -.02, .001, -.002}};
  for (int i = 0; i < n; ++i) {
    ring.intrinsics.push_back(camera);
    ring.cams_from_world.push_back(RingCamera(i));
  }
  const DistortionMap map(camera);
  uint64_t random = 0;
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < std::min(n, a + 4); ++b) {
      ViewPair pair{a, b, {}};
      while (static_cast<int>(pair.matches.size()) < matches) {
        const Eigen::Vector3d point(Wiggle(random), Wiggle(random + 1), Wiggle(random + 2));
        PointMatch match;
        bool is_seen = true;
        for (const bool first : {true, false}) {
          const Eigen::Vector3d in_camera = ring.cams_from_world[static_cast<size_t>(first ? a : b)] * point;
          Eigen::Vector2d& pixel = first ? match.a : match.b;
          const double x = in_camera.x() / in_camera.z(), y = in_camera.y() / in_camera.z();
          is_seen = is_seen && map.Sees(x, y) && map.Project(x, y, &pixel.x(), &pixel.y());
          pixel += Eigen::Vector2d(Wiggle(random + 3 + 2 * first), Wiggle(random + 4 + 2 * first)) / 3;
        }
        random += 7;
        if (is_seen) pair.matches.push_back(match);
      }
      ring.pairs.push_back(std::move(pair));
    }
  }
  return ring;
}

/// The poses turned by `degrees` and moved by `distance` about axes that differ from camera to camera.
inline std::vector<Eigen::Isometry3d> Perturbed(std::vector<Eigen::Isometry3d> cams_from_world, double degrees,
                                                double distance) {
  for (size_t i = 0; i < cams_from_world.size(); ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d(Wiggle(9 * i), Wiggle(9 * i + 1), Wiggle(9 * i + 2)).normalized();
    const Eigen::Vector3d way = Eigen::Vector3d(Wiggle(9 * i + 3), Wiggle(9 * i + 4), Wiggle(9 * i + 5)).normalized();
    Eigen::Isometry3d world_from_cam = cams_from_world[i].inverse();
    world_from_cam.linear() *= Eigen::AngleAxisd(degrees * std::acos(-1.) / 180, axis).toRotationMatrix();
    world_from_cam.translation() += distance * way;
    cams_from_world[i] = world_from_cam.inverse();
  }
  return cams_from_world;
}

}  // namespace oraclegs
