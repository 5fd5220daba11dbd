#pragma once
// DTU, BlendedMVS and scenes of one's own as NeuS and IDR have them: cameras_sphere.npz (or cameras.npz) with the
// matrices world_mat_i and scale_mat_i beside image/ and mask/. Image i of the sorted names is seen by the projection
// world_mat_i scale_mat_i, so that the scene's coordinates are those in which it fills the unit sphere.

#include <Eigen/Core>
#include <filesystem>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

bool IsNeusScene(const std::filesystem::path& root);

/// Reads the cameras with the images of image/, images/ or rgb/ and the masks of mask/ in the order of their names
/// where there are as many. Warns of skewed axes. Throws InputError naming the file and the matrix.
Scene ReadNeusScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

/// A projection P = K [R t], times any factor, taken apart; without an image size.
struct ProjectionParts {
  Camera camera;
  double skew = 0;  ///< pixels by which x moves for a y of 1 at depth 1
};

/// Throws InputError "PLACE: ..." when P is not finite or the projection of no camera.
ProjectionParts TakeApart(const Eigen::Matrix<double, 3, 4>& projection, const std::string& place);

}  // namespace oraclegs
