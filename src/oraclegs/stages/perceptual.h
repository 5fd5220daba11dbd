#pragma once
// LPIPS in a run: of the proposals' loss and among the scores.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/settings/plan.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// The loss of these proposals' --set proposal-lpips on the device of the training, and what to call it; empty where
/// there is no network or nothing asks for it, and, with a warning, where a proposal is too small for it.
struct TrainingLpips {
  PerceptualDistance distance;
  std::string convention;  ///< e.g. "VGG16, images in [0, 1]"
};
TrainingLpips LpipsOfProposals(const TrainOptions& options, const Plan& plan, const std::vector<TrainView>& proposals,
                               const Listener& listener);

/// The score "lpips" of images in [0, 1] as they are, which papers of the 3DGS family report, and "lpips_minus1_1" of
/// images in [-1, 1], which the authors of LPIPS ask for; `conventions` says so. Computed on `device`, or, with a
/// warning, on the CPU where libtorch has no CUDA. No scores without files.
ImageScores LpipsScores(const std::vector<std::filesystem::path>& files, Device device, const Listener& listener);

}  // namespace oraclegs
