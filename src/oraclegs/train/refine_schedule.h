#pragma once
// Iterations in which Gaussians are added or removed. Iterations count from 1.

#include "oraclegs/train/options.h"

namespace oraclegs {

/// Whether Gaussians may be added or removed after this iteration: before --set refine-stop, and never after the last
/// one, whose model is scored without further training.
bool IsBeforeRefineStop(const TrainOptions& options, int64_t iteration);

/// Whether densification takes place after this iteration: every --set refine-every between --set refine-start and
/// --set refine-stop.
bool Refines(const TrainOptions& options, int64_t iteration);

}  // namespace oraclegs
