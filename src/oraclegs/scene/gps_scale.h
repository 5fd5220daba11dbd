#pragma once
// Scale and vertical of a scene, from the GPS positions of its photos.

#include <Eigen/Core>
#include <optional>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

struct GpsScale {
  double unit_meters = 0;
  double error = 0;  ///< relative, one standard deviation
  int views = 0;     ///< with a GPS position
};

/// How many meters a unit of a level scene (LevelFrame: up is -y) has, by the GPS positions of its photos: the
/// similarity that brings the cameras' places on the ground onto them with the least squares. Heights are left out;
/// GPS knows them worst. Nothing when fewer than 5 photos have a position, when these lie within some 10 m, about the
/// error of a phone's GPS, or when they do not agree with the cameras: an error above 3 %.
std::optional<GpsScale> UnitMetersByGps(const Scene& scene);

/// Which way is up (unit, in the scene's frame, which need not be level), by the GPS positions with their heights: a
/// similarity in space, with the same conditions, and places that do not lie along one line.
std::optional<Eigen::Vector3d> UpByGps(const Scene& scene);

}  // namespace oraclegs
