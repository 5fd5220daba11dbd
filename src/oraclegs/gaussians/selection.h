#pragma once
// Some of the Gaussians of a model.

#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The Gaussians of these indices, in this order, in new memory on the host.
Gaussians Picked(const Gaussians& gaussians, const std::vector<int64_t>& indices);

/// The numbers of these Gaussians, in this order; none where there are none.
std::vector<float> Picked(const std::vector<float>& support, const std::vector<int64_t>& indices);

/// Those `most` of these Gaussians that cover and hide most (opacity times the area of the broadest side), in the order
/// given; all where there are no more. Of equals the first. The Gaussians are on the host.
std::vector<int64_t> MostPresent(const Gaussians& gaussians, std::vector<int64_t> indices, int64_t most);

}  // namespace oraclegs
