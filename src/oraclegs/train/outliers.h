#pragma once
// Gaussians that photos from few places cannot refute. Floaters hang in the air before a camera; depth refutes them.
// Oversized ones lie outside what the photos show, where nothing keeps Gaussians small: a few grow until their tails
// put a haze over every view that is taken a little aside.

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

/// Centers of the views' cameras in the world, [views,3].
std::vector<float> CameraCenters(const std::vector<TrainView>& views);

/// Caps scales at `share` (> 0) of the distance between the Gaussian's center and the nearest of `centers` ([n,3]).
/// Without centers all scales stay. The result does not depend on the number of threads. Throws ShapeError.
void CapScales(const std::vector<float>& centers, double share, Gaussians* gaussians);

}  // namespace oraclegs
