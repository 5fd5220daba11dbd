#pragma once
// What the trainer is given: views with what stereo knows of them, and options in which nothing is automatic.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/stages/stage.h"
#include "oraclegs/train/options.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// The options with everything that is automatic settled, by the images and what stereo found in them; what differs
/// from scene to scene is reported.
TrainOptions SettleTrainOptions(TrainOptions options, const TrainingViews& training, const Geometry& geometry,
                                const Listener& listener);

/// Where proxy models alone made the proposals and neither --schedule nor --set synthetic-floor says how often one is
/// taken: in a constant share of the iterations, half of the mean squared confidence (docs/method.md#schedules), which
/// is reported. Other options, and those without proposals, stay as they are.
TrainOptions SettleProxyDose(TrainOptions options, const std::vector<TrainView>& proposals, const Listener& listener);

/// --schedule union as a constant share: that of the proposals among all views. Other schedules stay as they are.
TrainOptions SettleUnion(TrainOptions options, size_t photos, size_t proposals);

/// {"rate-scale": 3.46, ...}: what `settled` has for the options that were automatic when the user asked.
nlohmann::json ChosenOptions(const TrainOptions& asked, const TrainOptions& settled);

/// The views as the trainer takes them: with depth where it is confident or a network's, with emptiness (inverse depth
/// 0) beside an object's silhouette unless `depth_loss` is the paper's, and starting from the exposures stereo found.
std::vector<TrainView> MakeTrainViews(const TrainingViews& training, const Geometry& geometry, DepthLoss depth_loss);

/// {"NAME": [12 numbers, the 3x4 color map row by row]} of trained exposures.
nlohmann::json ExposuresToJson(const std::vector<std::string>& names, const std::vector<ExposureMap>& exposures);

}  // namespace oraclegs
