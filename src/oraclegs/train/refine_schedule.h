#pragma once
// Iterations in which Gaussians are added or removed. Iterations count from 1.

#include "oraclegs/train/options.h"

namespace oraclegs {

/// Whether Densifier::Refine changes the Gaussians after this iteration: every --set refine-every between --set
/// refine-start and --set refine-stop, of settled options. Never after the last iteration, whose model is scored
/// without further training.
bool Refines(const TrainOptions& options, int64_t iteration);

/// Whether --densify adaptive resets all opacities after this iteration: at --opacity-reset-first and every
/// --opacity-reset after it, before --set refine-stop. Before a white background 3DGS does so once more, when
/// densification begins.
bool ResetsOpacities(const TrainOptions& options, bool is_background_white, int64_t iteration);

}  // namespace oraclegs
