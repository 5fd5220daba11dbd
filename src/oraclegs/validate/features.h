#pragma once
// Features of a pixel of a proposal, by which an oracle classifies it (docs/method.md#consistency-oracle).

#include <array>
#include <vector>

#include "oraclegs/propose/warp.h"

namespace oraclegs {

/// Names of the features, in their order.
inline constexpr std::array kFeatureNames = {
    "support",  // log of the views' support of the surface there
    "views",    // log of the views' support of the surface
    "angle",    // number of views that show it
    "spread",   // angle to the nearest of them
    "depth confidence",
    "conflicts",
    "occluded",
    "ring",
    "resolution",
    "background",
    "depth edge",    // how much depth changes around the pixel
    "texture",       // how much the proposal changes around the pixel
    "color",         // distance of the proposal's color from the warp's
    "color around",  // the same, mean over the pixels around
    "structure",     // 1 - correlation of the two images' patches, as far as they have texture
    "depth",         // relative difference of the proposal's own depth from stereo's
    "candidates",    // how much the candidates it was mixed from differ
    "gradient",      // how much the proposal changes from pixel to pixel
    "brightness",
    "border",  // nearness of the image's border, where few views overlap
};
inline constexpr size_t kFeatures = kFeatureNames.size();
using Features = std::array<float, kFeatures>;

/// Features of every pixel, row by row; all are finite. `warped` is the training views' warp at the proposal's pose.
std::vector<Features> FeaturesOf(const Proposal& proposal, const WarpedView& warped);

}  // namespace oraclegs
