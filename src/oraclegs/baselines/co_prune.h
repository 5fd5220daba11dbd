#pragma once
// Co-pruning of CoR-GS [Zhang 2024] (section 4.1): of two models of one scene, Gaussians that only one of them has are
// taken to be wrong.

#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The public code prunes after every 500th iteration beyond the first 500: every 5th densification, as in the paper.
inline constexpr int64_t kCoPruneInterval = 500;

/// 1 for each Gaussian of `model` that has a center of `other` at most max_distance away, 0 for those to prune. Find
/// the masks of both models before pruning either. Exact; on all threads, the result is the same for any number.
/// Centers must be finite. Throws ShapeError for buffers that do not fit.
/// max_distance: world units; 5 in the paper; the public code takes 5 on LLFF, 10 on DTU and 20 on Mip-NeRF 360. It is
/// not scaled by the scene: poses in another unit need another number.
std::vector<uint8_t> CoPruneKeep(const Gaussians& model, const Gaussians& other, double max_distance);

}  // namespace oraclegs
