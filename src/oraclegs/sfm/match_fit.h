#pragma once
// Verified matches held against given cameras: how far from its epipolar line a match lies.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/sfm/homography.h"

namespace oraclegs {

/// Errors are in pixels of an image whose longer side has this many, so that a limit means the same angle for a
/// thumbnail and for a large photo.
inline constexpr double kReferenceSide = 1000;

/// Matches between two of a list of views, by index.
struct ViewPair {
  int a = 0, b = 0;
  std::vector<PointMatch> matches;  ///< pixels of the full-size images
};

/// A pair's matches as rays of unit length, x right, y down, z forward.
struct RayPair {
  int a = 0, b = 0;
  std::vector<Eigen::Vector3d> rays_a, rays_b;
  double pixels_per_radian = 0;  ///< in the middle of an image of kReferenceSide
};

/// Distortion taken off. A match that no ray of its camera falls on is left out.
std::vector<RayPair> RaysOf(const std::vector<ViewPair>& pairs, const std::vector<Intrinsics>& intrinsics);

/// At most `limit` matches of each pair, evenly chosen.
std::vector<ViewPair> Thinned(const std::vector<ViewPair>& pairs, size_t limit);

/// Where camera b stands in the frame of camera a, and how far apart two cameras of the scene stand at most: a baseline
/// of a millionth of that is none.
struct Motion {
  Eigen::Isometry3d b_from_a;
  double extent = 0;
};

/// Pixels from which each match misses what the motion allows (Sampson's distance on the sphere of directions; without
/// a baseline the angle between the rays), and infinity where both cameras would have to see the point behind them.
/// Independent of the scene's unit and origin.
void AppendErrors(const RayPair& pair, const Motion& motion, std::vector<double>* errors);

/// The largest distance between two cameras.
double ExtentOf(const std::vector<Eigen::Isometry3d>& cams_from_world);

/// Motion between two of the cameras, exact also far from the origin.
Motion MotionBetween(const Eigen::Isometry3d& a_from_world, const Eigen::Isometry3d& b_from_world, double extent);

/// The share of numbers below `limit`; 0 for none.
double ShareBelow(const std::vector<double>& errors, double limit);

}  // namespace oraclegs
