#pragma once

#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// Throws UsageError where options of methods contradict each other, the way of densification or --iterations, and
/// something would be ignored without a word.
void CheckMethodOptions(const TrainOptions& options);

/// The parts of other methods that the options ask for, for a training of this setup. Throws as CheckMethodOptions, and
/// what the parts throw when they are made.
MethodParts MakeMethodParts(const TrainSetup& setup);

}  // namespace oraclegs
