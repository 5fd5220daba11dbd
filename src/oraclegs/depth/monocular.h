#pragma once
// Depth maps from a network's prediction for each single image, alone or beside stereo
// (docs/method.md#depth-alignment).

#include <cstdint>
#include <vector>

#include "oraclegs/depth/align.h"
#include "oraclegs/depth/depth_map.h"

namespace oraclegs {

/// A depth within this share of the truth is called right.
inline constexpr double kRightWithin = 0.05;

/// A network's depth has at most this confidence beside stereo: less than kConfident, so that confident depth is
/// stereo's.
inline constexpr float kMaxBesideStereo = 0.45f;

/// A view's depth, and how often it was right where the depth was known.
struct MonocularDepth {
  DepthMap map;
  double right = 0;  ///< [0, 1], of held-out known depths (of the points, where there is no stereo)
};

/// Where a map may have depth, height * width, 1 = yes; empty = everywhere.
using AllowedPixels = std::vector<uint8_t>;

/// The aligned map alone, `frame` giving name and camera. Its confidence is the share of `known` that it gets right.
/// What lies beyond infinity or before twice the nearest known depth is unknown.
MonocularDepth AlignedDepth(const DepthMap& frame, const RelativeDepth& relative, const Alignment& alignment,
                            const std::vector<KnownDepth>& known, const AllowedPixels& allowed);

/// The stereo map, and where that is not confident the aligned map, corrected by the confident depths (local_warp.h)
/// where there are enough. A quarter of the image's confident cells is held out first, to measure how often the
/// corrected map is right. The network's pixels have that share as confidence, at most kMaxBesideStereo. `relative` is
/// of the size of `stereo`.
MonocularDepth FusedDepth(const DepthMap& stereo, const RelativeDepth& relative, const Alignment& alignment,
                          const std::vector<KnownDepth>& known, const AllowedPixels& allowed);

/// Where stereo is confident, as known depths, a few thousand at most: for views with too few points.
std::vector<KnownDepth> ConfidentDepths(const DepthMap& stereo);

}  // namespace oraclegs
