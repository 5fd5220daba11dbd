#pragma once
// What the trainer is given: photographs with what stereo knows of them, and options in which nothing is left to
// choose.

#include <vector>

#include "oraclegs/pipeline/stages/depth_stage.h"
#include "oraclegs/train/options.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// The options with everything that is automatic decided, by the photographs and what stereo found in them; what
/// differs from scene to scene is told. docs/benchmarks.md has the measurements behind the choices.
TrainOptions DecideOptions(TrainOptions options, const std::vector<LoadedView>& photos, const Geometry& geometry,
                           const Listener& listener);

/// The photographs as training views: with depth where it is confident or a network's, with emptiness (inverse depth 0)
/// beside an object's silhouette, and starting from the exposures stereo found.
std::vector<TrainView> TrainViews(const std::vector<LoadedView>& photos, const Geometry& geometry);

/// {"NAME": [12 numbers, the 3x4 colour map row by row]} of trained exposures.
nlohmann::json ExposuresToJson(const std::vector<std::string>& names, const Buffer<float>& exposures);

}  // namespace oraclegs
