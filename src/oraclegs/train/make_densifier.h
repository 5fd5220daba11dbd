#pragma once

#include "oraclegs/train/densify.h"

namespace oraclegs {

/// Makes the densifier of 3DGS-MCMC on a CPU.
std::unique_ptr<Densifier> MakeMcmcDensifier(const DensifierSetup& setup);

}  // namespace oraclegs
