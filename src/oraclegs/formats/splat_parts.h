#pragma once
// Splats of a scene graph: Gaussians of several nodes, each at its place, as one splat.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {

struct SplatPart {
  Gaussians gaussians;
  int degree = 0;
  std::vector<float> support = {};
};

/// The transform of columns; nothing where it mirrors, or scales unevenly.
std::optional<Similarity> EvenSimilarity(const Eigen::Matrix4d& matrix);

/// All parts as one splat of their highest degree, turned by half a turn about an axis (values.h). Support is kept
/// where all of them have it: of a part it would mislead. Throws InputError naming `file` for no Gaussians.
GaussianPly JoinedParts(const std::vector<SplatPart>& parts, unsigned half_turn, const std::string& file);

}  // namespace oraclegs
