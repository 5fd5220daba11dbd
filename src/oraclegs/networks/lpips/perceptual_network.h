#pragma once
// LPIPS as the program sees it, with the features of targets that it has met.

#include <memory>

#include "oraclegs/networks/lpips/lpips.h"

namespace oraclegs {

/// cache_bytes: how much memory the features of targets may take; what does not fit is computed each time.
std::unique_ptr<PerceptualNetwork> MakePerceptualNetwork(Lpips lpips, int64_t cache_bytes);

}  // namespace oraclegs
