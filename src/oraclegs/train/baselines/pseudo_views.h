#pragma once
// Cameras where no photo was taken, on which FSGS [Zhu 2024] and CoR-GS [Zhang 2024] regularize. The papers describe
// one recipe (FSGS section 3.3, eq. 5; CoR-GS section 4.2), their public codes draw from two others, the random poses
// of RegNeRF [Niemeyer 2022]: a box for forward-facing scenes (LLFF, DTU), an ellipse for scenes seen from all around
// (Mip-NeRF 360, Blender). All three are here.
//
// Every function makes `count` cameras, each with the intrinsics of the training camera whose center is nearest; a pure
// function of its arguments. All throw UsageError without training cameras. The codes draw 10000 poses in advance.

#include <cstdint>
#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// The papers: between a random training camera and its nearest one. The center lies uniformly on the segment between
/// the two and is moved by normal noise; the rotation is the mean of theirs.
/// noise: standard deviation of each coordinate, in distances between the two (the papers name none: 0.1 is ours).
std::vector<Camera> PseudoViewsBetween(const std::vector<Camera>& cameras, int64_t count, uint64_t seed,
                                       double noise = 0.1);

/// How far away what the cameras see begins and ends, world units: the bounds of LLFF.
struct DepthBounds {
  double near_depth = 1, far_depth = 1;
};

/// The codes on forward-facing scenes: the center is uniform in the box, along the axes of the mean pose and centered
/// on it, that just holds all training cameras. All look at one point before the mean pose, as far away as
/// 1 / (0.25 / (0.9 near) + 0.75 / (5 far)). Throws UsageError unless 0 < near <= far.
std::vector<Camera> PseudoViewsInBox(const std::vector<Camera>& cameras, const DepthBounds& bounds, int64_t count,
                                     uint64_t seed);

/// The codes on scenes seen from all around: on an ellipse in the plane of the training cameras' largest spread. Its
/// axes are the 90th percentiles of their distances from the point nearest to all optical axes, at which all look; the
/// height over the plane varies with the angle by a tenth of the 10th to the 90th percentile.
std::vector<Camera> PseudoViewsOnEllipse(const std::vector<Camera>& cameras, int64_t count, uint64_t seed);

}  // namespace oraclegs
