#pragma once
// Stages of a training iteration: their times, amounts of work, and least possible work.

#include <array>
#include <vector>

#include "bench/ceilings.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// A stage of an iteration, by what bounds it.
enum class IterationStage { kProject, kBin, kBlend, kLoss, kBlendBackward, kUpdate };
inline constexpr std::array kStages{IterationStage::kProject, IterationStage::kBin,           IterationStage::kBlend,
                                    IterationStage::kLoss,    IterationStage::kBlendBackward, IterationStage::kUpdate};
/// "project", "bin", ...
const char* StageName(IterationStage stage);
/// Whether computation bounds the stage: kBlend and kBlendBackward; memory bounds the others.
bool IsComputeBound(IterationStage stage);

/// One iteration, or a mean or median of several.
struct IterationSample {
  std::array<double, kStages.size()> milliseconds{};
  double visible = 0;               ///< Gaussians
  double tile_pairs = 0;            ///< (tile, Gaussian)
  double pixel_pairs = 0;           ///< evaluated by blend forward
  double pixel_pairs_backward = 0;  ///< evaluated by blend backward
  double total = 0;                 ///< ms, whole iteration

  double Milliseconds(IterationStage stage) const { return milliseconds[static_cast<size_t>(stage)]; }
};

/// Runs one step of the trainer and measures it.
IterationSample TimedStep(Trainer* trainer);

/// Medians, field by field.
IterationSample MedianOf(const std::vector<IterationSample>& samples);

/// Size of one iteration's input.
struct IterationShape {
  double gaussians = 0, pixels = 0;
};

/// Least floating-point operations (IsComputeBound) or bytes of the stage.
double LeastWork(IterationStage stage, const IterationShape& shape, const IterationSample& found);

/// Least work per second as a fraction of the ceiling. Above 1 a memory-bound stage works from the caches.
double ShareOfCeiling(IterationStage stage, const IterationShape& shape, const IterationSample& found,
                      const Ceilings& ceilings);

}  // namespace oraclegs
