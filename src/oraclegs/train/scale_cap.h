#pragma once
// Gaussians beside what the photos show have nothing to keep them small: a few grow until their tails veil every
// view that is taken a little aside.

#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Of the views' cameras, world, [views,3].
std::vector<float> CameraCenters(const std::vector<TrainView>& views);

/// Scales become at most `share` (> 0) of the distance between the Gaussian's center and the nearest of `centers`
/// ([n,3]); without any, all stay as they are. The same bits for any number of threads. Throws ShapeError.
void CapScales(const std::vector<float>& centers, double share, Gaussians* gaussians);

}  // namespace oraclegs
