#pragma once
// Gaussians that hang in the air before a camera: photos from few places cannot refute them, depth can.

#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/constants.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Lowers the opacity of every living Gaussian to below kDeadOpacity, so that RelocateDead moves it, whose center lies
/// before the surface in at least one view and in at least as many as it lies on the surface of. A view has a say where
/// the center falls on a pixel of trusted depth. Nothing happens when no Gaussian would be left alive. Returns how
/// many died. The same for any number of threads.
int64_t PruneFloaters(const std::vector<TrainView>& views, Gaussians* gaussians);

}  // namespace oraclegs
