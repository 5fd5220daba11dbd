#pragma once

#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// The parts of other methods that the options ask for, for a training of this setup. Throws UsageError where they
/// contradict each other.
MethodParts MakeMethodParts(const TrainSetup& setup);

}  // namespace oraclegs
