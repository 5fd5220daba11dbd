#pragma once

#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// Throws UsageError where options of methods contradict each other, --densify or --iterations, so that none is ignored
/// silently.
void CheckMethodOptions(const TrainOptions& options);

/// Makes the parts that the options ask for. Throws as CheckMethodOptions and as the parts' constructors.
MethodParts MakeMethodParts(const TrainSetup& setup);

}  // namespace oraclegs
