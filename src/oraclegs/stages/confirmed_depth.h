#pragma once
// What dense stereo confirms of a model that registration found.

#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// The share of confident pixels in the depth map of each view, from small copies of the images. Takes about a second
/// an image on two cores. Throws Interrupted, InputError for an image that cannot be read, and the errors of
/// MakePlaneSearch.
std::vector<double> ConfirmedDepth(Scene model, Device device);

}  // namespace oraclegs
