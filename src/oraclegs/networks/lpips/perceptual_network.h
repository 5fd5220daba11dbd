#pragma once
// LPIPS behind the program's interface, with a cache of the features of targets.

#include <memory>

#include "oraclegs/networks/lpips/lpips.h"

namespace oraclegs {

/// cache_bytes: memory that the features of targets may take; features that do not fit are computed each time.
std::unique_ptr<PerceptualNetwork> MakePerceptualNetwork(Lpips lpips, int64_t cache_bytes);

}  // namespace oraclegs
