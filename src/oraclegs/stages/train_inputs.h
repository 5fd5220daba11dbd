#pragma once
// Inputs of the trainer: views with what stereo knows of them, and the evidence that its options are settled from.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/settings/from_results.h"
#include "oraclegs/stages/stage.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Evidence of the photos and their depth; none yet of proposals.
TrainEvidence EvidenceOf(const TrainingViews& training, const Geometry& geometry);

/// Mean over all pixels of the proposals; nullopt without proposals.
std::optional<double> MeanSquaredConfidence(const std::vector<TrainView>& proposals);

/// The views as the trainer takes them: with depth where it is confident or a network's, with emptiness (inverse depth
/// 0) beside an object's silhouette unless `depth_loss` is the paper's, and starting from the exposures stereo found.
std::vector<TrainView> MakeTrainViews(const TrainingViews& training, const Geometry& geometry, DepthLoss depth_loss);

/// {"NAME": [12 numbers, the 3x4 color map row by row]} of trained exposures.
nlohmann::json ExposuresToJson(const std::vector<std::string>& names, const std::vector<ExposureMap>& exposures);

}  // namespace oraclegs
