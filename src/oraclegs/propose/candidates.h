#pragma once
// Families of poses from which a scene might be looked at, by its training cameras alone. Every function returns at
// most `count` cameras with the intrinsics of the first training camera, fewer (or none) where the training cameras do
// not say enough: one camera makes no path. They are not checked against geometry or test poses (target_check.h).

#include <cstdint>
#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// Photographs taken all around: circles that look at the point nearest to all axes, as far away as the photographs in
/// that direction, on one to four elevations between the lowest and the highest photograph. Otherwise an open path
/// through the training poses in the order in which they lie beside each other.
std::vector<Camera> OrbitCandidates(const std::vector<Camera>& train, int count);

/// Cameras that look one way (within 45 degrees): a spiral around the mean pose, as wide as the cameras are spread, as
/// forward-facing captures are flown through [Mildenhall 2019]. Otherwise around what they look at, over the azimuths
/// that were photographed, while the elevation rises and falls over the photographs' range.
std::vector<Camera> SpiralCandidates(const std::vector<Camera>& train, int count);

/// A smooth path through all training poses from neighbour to neighbour, evenly spaced along its length (of a camera
/// that only turns: by angle) and never at a training pose.
std::vector<Camera> InterpolatedCandidates(const std::vector<Camera>& train, int count);

/// Random poses between pairs of neighbouring training cameras, moved aside by up to 0.3 of their distance.
std::vector<Camera> JitteredCandidates(const std::vector<Camera>& train, int count, uint64_t seed);

}  // namespace oraclegs
