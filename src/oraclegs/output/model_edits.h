#pragma once
// Edits of a model for an export: which Gaussians stay, and their orientation.

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/gaussians/transform.h"

namespace oraclegs {

/// A part of space, in the scene's axes. kAuto stands for the ball that the cameras look at, which the caller must
/// find.
struct Crop {
  enum class Kind { kNone, kAuto, kBox, kBall };
  Kind kind = Kind::kNone;
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  ///< corners of a box
  Ball ball{Eigen::Vector3d::Zero(), 0};

  bool Holds(const Eigen::Vector3d& point) const;
  Crop MovedBy(const Eigen::Vector3d& way) const;
};

inline constexpr const char* kCropHelp =
    "Keep this part: auto (around what the cameras look at), box:x0,y0,z0,x1,y1,z1 or sphere:x,y,z,radius, in the axes "
    "of the scene";

/// "", "auto", "box:x0,y0,z0,x1,y1,z1" or "sphere:x,y,z,r". Throws UsageError that shows the forms.
Crop ParseCrop(const std::string& text);

/// Indices of the Gaussians whose means the crop holds, which is in coordinates that `crop_from_gaussians` leads to.
std::vector<int64_t> HeldBy(const Crop& crop, const Gaussians& gaussians, const Similarity& crop_from_gaussians);

/// Unit vector of "x", "-x", "y", "-y", "z" or "-z"; nullopt for "" and "auto". Throws UsageError.
std::optional<Eigen::Vector3d> ParseAxis(const std::string& text);

/// True for outliers: the root mean square distance to the three nearest Gaussians is far above the median of all (by
/// 3.5 robust standard deviations of its logarithm), and the Gaussian itself reaches less far (three standard
/// deviations).
std::vector<bool> OutlierGaussians(const Gaussians& gaussians);

/// Shortest rotation from one direction to another, both of unit length.
Eigen::Matrix3d TurnBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace oraclegs
