#pragma once
// Where another view shows a pixel, and how that changes with poses and depth (docs/method.md#pose-refinement).

#include <Eigen/Core>
#include <optional>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// A small motion of a camera in its own frame, (shift, turn): R' = exp(turn) R, t' = exp(turn) t + shift. Shifts in
/// world units, turns in radians.
using Twist = Eigen::Matrix<double, 6, 1>;

Camera Stepped(const Camera& camera, const Twist& twist);

/// The motion from one pose to another: Stepped(from, TwistBetween(from, to)) has the pose of `to`.
Twist TwistBetween(const Camera& from, const Camera& to);

/// A view's pixel center with its inverse depth, 1/world unit.
struct DeepPixel {
  double u = 0, v = 0, inv_depth = 0;
};

/// A pixel of one view in another, with derivatives.
struct Reprojection {
  Eigen::Vector2d at;                    ///< pixels of the other view
  double depth_ratio = 0;                ///< depth in the other view over depth in the pixel's own
  Eigen::Matrix<double, 2, 6> by_view;   ///< by the twist of the pixel's view
  Eigen::Matrix<double, 2, 6> by_other;  ///< by the twist of the other view
  Eigen::Vector2d by_inv_depth;          ///< along the epipolar line
};

/// Returns nullopt where the point is behind the other camera.
std::optional<Reprojection> Reproject(const Camera& view, const Camera& other, const DeepPixel& pixel);

}  // namespace oraclegs
