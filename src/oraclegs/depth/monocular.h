#pragma once
// Depth maps from what a network guesses of each photograph alone, alone or beside stereo.

#include <cstdint>
#include <vector>

#include "oraclegs/depth/align.h"
#include "oraclegs/depth/depth_map.h"

namespace oraclegs {

/// A depth that is within this share of the truth is called right.
inline constexpr double kRightWithin = 0.05;

/// A network's depth has at most this confidence beside stereo: less than kConfident, so that nothing that asks for
/// confident depth takes one for the other.
inline constexpr float kMostBesideStereo = 0.45f;

/// A photograph's depth, and how often it was right where the depth was known.
struct MonocularDepth {
  DepthMap map;
  double right = 0;  ///< [0, 1], of what was known but not told (of the points, where there is no stereo)
};

/// Where a map may say anything, height * width, 1 = yes; empty = everywhere.
using AllowedPixels = std::vector<uint8_t>;

/// The aligned map alone, `frame` giving name and camera. Its confidence is the share of `known` that it gets right.
/// What lies beyond infinity or before twice the nearest known depth is unknown.
MonocularDepth AlignedDepth(const DepthMap& frame, const RelativeDepth& relative, const Alignment& alignment,
                            const std::vector<KnownDepth>& known, const AllowedPixels& allowed);

/// The stereo map, and where that is not confident the aligned map, bent to what is confident (local_warp.h) where
/// there is enough of it. To know how far to believe that, it is first bent to three quarters of the confident cells of
/// the picture and compared with the last. The network's pixels have the share that was right as confidence, at most
/// kMostBesideStereo. `relative` is of the size of `stereo`.
MonocularDepth FusedDepth(const DepthMap& stereo, const RelativeDepth& relative, const Alignment& alignment,
                          const std::vector<KnownDepth>& known, const AllowedPixels& allowed);

/// Where stereo is confident, as known depths, a few thousand at most: for photographs with too few points.
std::vector<KnownDepth> ConfidentDepths(const DepthMap& stereo);

}  // namespace oraclegs
