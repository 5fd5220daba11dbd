#pragma once
// Comparison of a proposal with the images' view of its pose, at several scales (docs/method.md#tamper-trained-oracle).

#include <array>
#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Names of the comparisons, in their order; they come after the features (features.h). "near" is a window of 7 x 7
/// pixels, "wide" and "wider" grow with the image.
inline constexpr std::array kComparisonNames = {
    "color",           // distance of the two colors, mean over a wide window
    "shift near",      // distance of the two mean colors of windows, which ignores details
    "shift wide",      //
    "shift wider",     //
    "structure",       // 1 - correlation of two wide windows, as far as they have texture
    "sharpness near",  // log of the proposal's deviation of brightness by the other image's
    "sharpness wide",  //
};
inline constexpr size_t kComparisons = kComparisonNames.size();
using Comparison = std::array<float, kComparisons>;

/// Comparisons for every pixel, row by row; all are finite. Throws ShapeError for images of different sizes.
std::vector<Comparison> Compare(const ImageF& proposal, const ImageF& shown);

}  // namespace oraclegs
