#pragma once
// Inputs of the trainer: views with what stereo knows of them, and the evidence that its options are settled from.

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/settings/from_results.h"
#include "oraclegs/stages/stage.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Evidence of the photos and their depth; none yet of proposals.
TrainEvidence EvidenceOf(const TrainingViews& training, const Geometry& geometry);

/// Mean over the pixels of the proposals that can teach something: with a `backdrop`, the color before which an object
/// stands, all that differ from it. nullopt without such pixels.
std::optional<double> MeanSquaredConfidence(const std::vector<TrainView>& proposals,
                                            const std::optional<std::array<float, 3>>& backdrop);

/// Choices of the run in how training uses its views.
struct ViewUse {
  DepthLoss depth_loss = DepthLoss::kRelative;
  Background background = Background::kBlack;
};

/// The use that the run's options and plan ask for.
ViewUse ViewUseOf(const Run& run);

/// The views as the trainer takes them: with depth where it is confident or a network's, and starting from the
/// exposures stereo found. Unless the depth loss is the paper's there is emptiness beside an object's silhouette:
/// inverse depth 0, and, where a mask shows the silhouette, the background's color and alpha 0. Their images are
/// otherwise those of `training`, which must outlive them.
std::vector<TrainView> MakeTrainViews(const TrainingViews& training, const Geometry& geometry, ViewUse use);

/// Does the same, but takes the images and frees the depth, so that neither lies in memory twice.
std::vector<TrainView> TakeTrainViews(TrainingViews* training, Geometry* geometry, ViewUse use);

/// {"NAME": [12 numbers, the 3x4 color map row by row]} of trained exposures.
nlohmann::json ExposuresToJson(const std::vector<std::string>& names, const std::vector<ExposureMap>& exposures);
/// Reads them back from a run's exposures.json, in the order of `names`. Throws InputError naming the file when it is
/// damaged or lacks one.
std::vector<ExposureMap> ReadExposures(const std::filesystem::path& file, const std::vector<std::string>& names);

// Where the depth of pseudo views comes from in a run (baselines/baseline_setup.h): a network where there is one, else
// stereo.

/// Depth that Depth Anything V2 sees in the render itself, as FSGS has it: the render is moved, too. Networks compute
/// on `device`, or, with a warning, on the CPU where libtorch has no CUDA. Throws InputError for a file that is none.
PseudoDepth NetworkPseudoDepth(const std::filesystem::path& weights, Device device, const Listener& listener);

/// Stereo's depth of the views, seen from there (propose/warp.h): stands in for a network's. Counts where a depth
/// map shows a surface, or nothing beside an object; without any depth it counts nowhere. Throws ShapeError as Warper.
PseudoDepth StereoPseudoDepth(std::vector<LoadedView> views, std::vector<DepthMap> maps);

}  // namespace oraclegs
