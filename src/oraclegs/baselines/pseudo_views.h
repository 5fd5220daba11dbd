#pragma once
// Pseudo views: cameras where no photo was taken. CoR-GS [Zhang 2024] (section 4.2) compares its two models from them,
// FSGS [Zhu 2024] (section 3.3) looks at depth; the recipe is that of FSGS (eq. 5). The public codes draw 10000 poses
// in advance, in other places than the papers say: in a box before forward-facing scenes, on an ellipse around others.

#include <cstdint>
#include <vector>

#include "oraclegs/camera/camera.h"

namespace oraclegs {

/// Number of pseudo views to draw from. The authors draw 10000 in advance; a run of as many iterations sees each at
/// most once.
inline constexpr int64_t kPseudoViews = 2000;

/// `count` cameras, each between a random training camera and its nearest one. The center lies uniformly on the segment
/// between the two and is moved by normal noise; the rotation is the mean of theirs; the intrinsics are those of the
/// training camera whose center is nearest. A pure function of its arguments. Throws UsageError without any.
/// noise: standard deviation of each coordinate, in distances between the two (the papers name none: 0.1 is ours).
std::vector<Camera> PseudoViewsBetween(const std::vector<Camera>& cameras, int64_t count, uint64_t seed,
                                       double noise = 0.1);

/// Draws one of `views`, which are not empty, for an iteration. A pure function of its arguments.
const Camera& DrawPseudoView(const std::vector<Camera>& views, uint64_t seed, int64_t iteration);

}  // namespace oraclegs
