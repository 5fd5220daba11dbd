#pragma once
// What the trainer is given: photographs with what stereo knows of them, and options in which nothing is left to
// choose.

#include <vector>

#include "oraclegs/pipeline/depth_stage.h"
#include "oraclegs/train/options.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Exposures that spread by more than this (ExposureSpread) are learnt by --exposure auto: below, what looks like
/// exposure is as likely gloss and shadow.
inline constexpr double kVariedExposure = 0.04;

/// The options with every "auto" decided by what stereo found; what was decided is told.
TrainOptions DecideOptions(TrainOptions options, const Geometry& geometry, const Listener& listener);

/// The photographs as training views: with depth where stereo is confident, with emptiness (inverse depth 0) beside an
/// object's silhouette, and starting from the exposures stereo found.
std::vector<TrainView> TrainViews(const std::vector<Photo>& photos, const Geometry& geometry);

/// {"NAME": [12 numbers, the 3x4 colour map row by row]} of trained exposures.
nlohmann::json ExposuresToJson(const std::vector<Photo>& photos, const Tensor& exposures);

}  // namespace oraclegs
