#pragma once

#include "oraclegs/train/densify.h"

namespace oraclegs {

/// Of --densify.
std::unique_ptr<Densifier> MakeDensifier(const DensifierSetup& setup);

}  // namespace oraclegs
