#pragma once

#include "oraclegs/train/densify.h"

namespace oraclegs {

/// Makes the densifier of --densify.
std::unique_ptr<Densifier> MakeDensifier(const DensifierSetup& setup);

}  // namespace oraclegs
