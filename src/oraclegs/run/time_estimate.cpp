#include "oraclegs/run/time_estimate.h"

#include <algorithm>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

// Bytes.
constexpr double kProgramBytes = 150e6, kBytesOfGaussian = 1100, kBytesOfViewPixel = 34, kBytesOfProposalPixel = 24,
                 kBytesOfWorkPixel = 170, kBytesOfLoadedPixel = 44;

}  // namespace

double EstimateSeconds(const Stage& stage, const EstimateInput& input) {
  return stage.work.seconds != nullptr ? input.slowness * stage.work.seconds(input) : 0;
}

int64_t EstimateRunMemory(const EstimateInput& input) {
  const double pixels = PixelsOfView(input);
  const double held =
      kBytesOfViewPixel * pixels * input.scene.views + kBytesOfProposalPixel * pixels * ProposalsOf(input);
  const double loading = kBytesOfLoadedPixel * FullPixels(input) * std::min(NumThreads(), input.scene.views);
  const double training = kBytesOfGaussian * input.options.train.max_gaussians.value() + kBytesOfWorkPixel * pixels;
  return static_cast<int64_t>(kProgramBytes + held + std::max(loading, training));
}

}  // namespace oraclegs
