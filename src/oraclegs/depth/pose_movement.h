#pragma once
// How far cameras moved, and the change of coordinates that goes with it (docs/method.md#pose-refinement).

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/camera/similarity.h"

namespace oraclegs {

/// The similarity that maps cameras to the same cameras with other poses: rotation and scale are those of all, and each
/// camera that moved against the others has little weight. The identity without cameras.
Similarity SimilarityBetween(const std::vector<Camera>& from, const std::vector<Camera>& to);

/// Other cameras of the scene (test views, say), where they are once the cameras `from` became `to`.
std::vector<Camera> Following(std::vector<Camera> others, const std::vector<Camera>& from,
                              const std::vector<Camera>& to);

/// A camera's movement against the others.
struct CameraMovement {
  double degrees = 0;  ///< of the rotation
  double share = 0;    ///< of the center, as a share of the scene extent (SpatialExtent)
};

/// The movement that SimilarityBetween leaves of each camera.
std::vector<CameraMovement> Movements(const std::vector<Camera>& from, const std::vector<Camera>& to);

}  // namespace oraclegs
