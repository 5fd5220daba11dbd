#pragma once
// What there is to say about a pixel of a proposal before one decides whether to trust it.

#include <array>
#include <vector>

#include "oraclegs/propose/warp.h"

namespace oraclegs {

/// What the features are, in their order.
inline constexpr std::array kFeatureNames = {
    "support",  // log of the photographs' support of the surface there
    "views",    // how many photographs show it
    "angle",    // to the nearest of them
    "spread",   // of their colours
    "depth confidence",
    "conflicts",
    "hidden",
    "ring",
    "resolution",
    "background",
    "depth edge",     // how much depth changes around the pixel
    "texture",        // how much the proposal changes around the pixel
    "colour",         // distance of the proposal's colour from the photographs'
    "colour around",  // the same, mean over the pixels around
    "structure",      // 1 - correlation of the two pictures' patches, as far as they have texture
    "depth",          // relative difference of the proposal's own depth from stereo's
    "candidates",     // how much the candidates it was mixed from differ
    "gradient",       // how much the proposal changes from pixel to pixel
    "brightness",
    "border",  // nearness of the picture's border, where few photographs overlap
};
inline constexpr size_t kFeatures = kFeatureNames.size();
using Features = std::array<float, kFeatures>;

/// Of every pixel, row by row. `warped` is what the photographs show in the proposal's view. Every value is finite.
std::vector<Features> FeaturesOf(const Proposal& proposal, const WarpedView& warped);

}  // namespace oraclegs
