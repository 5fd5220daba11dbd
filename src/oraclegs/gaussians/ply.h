#pragma once
// The de-facto 3DGS point cloud file (docs/method.md#ply-and-checkpoint).

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// Writes binary little-endian PLY of SH degree `sh_degree` (0..3), atomically; comments stand in its header, a line
/// each. `support`: [N] in [0, 1], the last property of each Gaussian, which other viewers ignore; empty = none
/// (evaluate/support.h). Throws RunError.
void WriteGaussianPly(const std::filesystem::path& path, const Gaussians& gaussians, int sh_degree = kMaxShDegree,
                      const std::vector<std::string>& comments = {}, const std::vector<float>& support = {});

struct GaussianPly {
  Gaussians gaussians;
  int sh_degree = 0;  ///< of the file; higher coefficients are zero
  std::vector<std::string> comments = {};
  std::vector<float> support = {};  ///< [N] in [0, 1], how far the images support each Gaussian; empty = unknown
};

/// Reads such a file from any trainer: properties found by name in any order, other properties and elements skipped,
/// ascii and both binary byte orders, float or double. Throws InputError naming the file: no such element or
/// property, a vertex count that the file cannot hold, values that are not finite, a support outside [0, 1]; only an
/// infinite opacity is accepted, as +-15.
GaussianPly ReadGaussianPly(const std::filesystem::path& path);

}  // namespace oraclegs
