#pragma once
// Floaters: Gaussians that hang in the air before a camera. Photos from few places cannot refute them, depth can.

#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/constants.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Lowers the opacity of floaters to below kDeadOpacity, so that RelocateDead moves them. A floater is a living
/// Gaussian whose center falls on an empty pixel in some view, or lies before the surface in at least one view and in
/// at least as many views as it lies on the surface. A view contributes a vote where the center falls on a pixel of
/// trusted depth. Does nothing when no Gaussian would be left alive. Returns the number of floaters. The result does
/// not depend on the number of threads.
int64_t PruneFloaters(const std::vector<TrainView>& views, Gaussians* gaussians);

}  // namespace oraclegs
