#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The rows of a model, in order, without its far dust: nearly transparent, small Gaussians that the noise of training
/// has carried more than twelve times the extent of the middle 99 % away from it. Nobody sees them, but programs that
/// frame a model by its box show a dot. All rows of fewer than 1000 Gaussians.
std::vector<int64_t> WithoutFarDust(const Gaussians& gaussians);

}  // namespace oraclegs
