#pragma once
// Families of target poses, from the training cameras alone (docs/method.md#target-poses). Every function returns at
// most `count` cameras with the intrinsics of the first training camera: fewer, or none, where the training cameras do
// not define them (one camera makes no path). Geometry and test poses are checked later (target_check.h).

#include <cstdint>
#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// For views all around: circles that look at the point nearest to all axes, at the distance of the views in that
/// direction, on one to four elevations between the lowest and the highest view. Otherwise: an open path through the
/// training poses in NearestOrder.
std::vector<Camera> OrbitCandidates(const std::vector<Camera>& train, int count);

/// For cameras that look one way (within 45 degrees): a spiral around the mean pose with the extent of the cameras, as
/// in [Mildenhall 2019]. Otherwise: a path around the point they look at, over the azimuths of the views, with an
/// elevation that rises and falls over their range.
std::vector<Camera> SpiralCandidates(const std::vector<Camera>& train, int count);

/// A smooth path through all training poses from neighbor to neighbor, evenly spaced along its length (for a pure
/// rotation: by angle) and never at a training pose.
std::vector<Camera> InterpolatedCandidates(const std::vector<Camera>& train, int count);

/// Random poses between pairs of neighboring training cameras, moved aside by up to 0.3 of their distance.
std::vector<Camera> JitteredCandidates(const std::vector<Camera>& train, int count, uint64_t seed);

}  // namespace oraclegs
