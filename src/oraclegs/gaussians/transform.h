#pragma once
// A model somewhere else: turned, scaled and moved as one rigid thing.

#include <Eigen/Core>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// How coefficients of spherical harmonics change when what they describe is turned: c' = D c, block by block of a
/// degree, by the recursion of [Ivanic 1996].
using ShRotation = Eigen::Matrix<float, kShCoefficients, kShCoefficients>;
ShRotation RotationOfHarmonics(const Eigen::Matrix3d& rotation);

/// The transformed Gaussians in new memory on the host: an image of them, taken by a camera that is transformed in the
/// same way, stays the same.
Gaussians Transformed(const Gaussians& gaussians, const Similarity& transform);

}  // namespace oraclegs
