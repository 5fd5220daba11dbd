#pragma once
// Whether the matches of two images follow one motion of the camera, or whether something moved, or stood still, on its
// own.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "oraclegs/sfm/homography.h"

namespace oraclegs {

/// All features of two images that look alike.
struct AlikeFeatures {
  std::vector<PointMatch> inliers;            ///< that one motion explains
  std::vector<PointMatch> outliers;           ///< the others
  std::optional<Eigen::Matrix3d> homography;  ///< as colmap gave it, where one explains most inliers
  double side = 0;                            ///< pixels of the longer side of the larger image
};

/// Numbers of these features by what they do.
struct MotionCounts {
  int still = 0;   ///< stay at their pixel
  int nearly = 0;  ///< move by a little: where cameras circle around a point, many do
  int moving = 0;  ///< inliers that move clearly
  int apart = 0;   ///< outliers that agree on a motion of their own, far from what the inliers' allows
  int planar = 0;  ///< inliers that one homography explains to two pixels of a thousand
  int inliers = 0;

  /// True when something stands still in both images while others move, as behind a turntable or a watermark does.
  bool HasStillPart() const;
  /// True when something moved between the images on its own.
  bool HasMovedPart() const;
  /// True when the inliers lie on one plane.
  bool IsPlanar() const;
};

/// Counts depend on the features alone: the sample is drawn by their number.
MotionCounts CountMotions(const AlikeFeatures& features);

}  // namespace oraclegs
