#pragma once
// Depth maps from a network's prediction for each single image, alone or combined with stereo
// (docs/method.md#depth-alignment).

#include <cstdint>
#include <vector>

#include "oraclegs/depth/align.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Largest relative error of a depth that counts as right.
inline constexpr double kRightWithin = 0.05;

/// Largest confidence of a network's depth beside stereo: less than kConfident, so that confident depth is stereo's.
inline constexpr float kMaxBesideStereo = 0.45f;

/// A view's depth, and how often it was right where the true depth was known.
struct MonocularDepth {
  DepthMap map;
  double right = 0;  ///< [0, 1], fraction right of held-out known depths (of the points, where there is no stereo)
};

/// Pixels in which a map may have depth, height * width, 1 = yes; empty = everywhere.
using AllowedPixels = std::vector<uint8_t>;

/// Pixels that a view's mask and its object's silhouette allow; empty = all.
AllowedPixels PixelsWithDepth(const LoadedView& view, const Silhouettes& silhouettes, size_t v);

/// The aligned map alone; `frame` gives name and camera. Its confidence is the fraction of `known` that it gets right.
/// Depth is unknown beyond infinity and nearer than half the nearest known depth.
MonocularDepth AlignedDepth(const DepthMap& frame, const RelativeDepth& relative, const Alignment& alignment,
                            const std::vector<KnownDepth>& known, const AllowedPixels& allowed);

/// Like AlignedDepth, but no depth is too near, and the confidence is at least kLeastOfWhole: for a loss that takes
/// every map as it is.
MonocularDepth WholeDepth(const DepthMap& frame, const RelativeDepth& relative, const Alignment& alignment,
                          const std::vector<KnownDepth>& known, const AllowedPixels& allowed);
inline constexpr double kLeastOfWhole = 0.02;

/// The stereo map and, where it is not confident, the aligned map, corrected by the confident depths (local_warp.h)
/// where there are enough. A quarter of the image's confident cells is held out first, to measure how often the
/// corrected map is right; that fraction, at most kMaxBesideStereo, is the confidence of the network's pixels.
/// `relative` has the size of `stereo`.
MonocularDepth FusedDepth(const DepthMap& stereo, const RelativeDepth& relative, const Alignment& alignment,
                          const std::vector<KnownDepth>& known, const AllowedPixels& allowed);

/// Confident stereo depths as known depths, a few thousand at most: for views with too few points.
std::vector<KnownDepth> ConfidentDepths(const DepthMap& stereo);

}  // namespace oraclegs
