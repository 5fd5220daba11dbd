#pragma once
// Oversized Gaussians: outside what the photos show nothing keeps Gaussians small, and a few grow until their tails put
// a haze over every view that is taken a little aside.

#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Centers of the views' cameras in the world, [views,3].
std::vector<float> CameraCenters(const std::vector<TrainView>& views);

/// Caps scales at `share` (> 0) of the distance between the Gaussian's center and the nearest of `centers` ([n,3]).
/// Without centers all scales stay. The result does not depend on the number of threads. Throws ShapeError.
void CapScales(const std::vector<float>& centers, double share, Gaussians* gaussians);

}  // namespace oraclegs
