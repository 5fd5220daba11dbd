#include "oraclegs/pipeline/estimate/time_estimate.h"

#include <algorithm>

#include "oraclegs/core/parallel.h"
#include "oraclegs/pipeline/settings/plan.h"
#include "oraclegs/pipeline/stages/proxy_models.h"

namespace oraclegs {
namespace {

// Seconds on the reference machine.
constexpr double kFeaturesOfPhoto = 2.2, kMatchOfPair = 0.35, kMapping = 5, kMappingOfPhoto = 0.5;
constexpr double kStereoOfPixel = 24e-6, kStereo = 3;
constexpr double kIterationOfPixel = 59e-9, kIterationOfGaussian = 107e-9, kIteration = 0.5e-3;
constexpr double kProposeOfPixel = 0.35e-6, kPropose = 3;
constexpr double kValidateOfPixel = 4e-6, kValidate = 2;
constexpr double kRenderOfPixel = 0.1e-6, kRenderOfGaussian = 30e-9;
constexpr double kReport = 4;
constexpr int kOrbitFrames = 96;

// Bytes.
constexpr double kProgramBytes = 150e6, kBytesOfGaussian = 1100, kBytesOfViewPixel = 34, kBytesOfProposalPixel = 24,
                 kBytesOfWorkPixel = 170, kBytesOfLoadedPixel = 44;

double PixelsOfView(const EstimateInput& input) {
  const PixelSize size = WorkingSize(input.scene.largest, input.options.image);
  return static_cast<double>(size.width) * size.height;
}

double PairsOf(int photos) { return 0.5 * photos * (photos - 1); }

int ProposalsOf(const EstimateInput& input) {
  const RunOptions& options = input.options;
  if (!ProposesViews(options)) return 0;
  return options.trajectory.proposals.ValueOr(options.propose.ByProxiesAlone() ? kProxyProposals : kUsualProposals);
}

double SecondsOfIteration(const EstimateInput& input) {
  return kIteration + kIterationOfPixel * PixelsOfView(input) +
         kIterationOfGaussian * input.options.train.max_gaussians.value();
}

double SecondsOfFeatures(int photos) {
  return kFeaturesOfPhoto * photos + kMatchOfPair * PairsOf(photos) + kMapping + kMappingOfPhoto * photos;
}

double SecondsOfProxies(const EstimateInput& input) {
  const ProposeOptions& propose = input.options.propose;
  if (!propose.Uses(ProposerChoice::kSplat)) return 0;
  const double iterations = (propose.proxy_share + propose.proxy_finish) * input.options.train.iterations.value();
  return ProxyCount(propose, input.scene.views) * iterations * SecondsOfIteration(input);
}

double SecondsOfRender(const EstimateInput& input) {
  return kRenderOfPixel * PixelsOfView(input) + kRenderOfGaussian * input.options.train.max_gaussians.value();
}

}  // namespace

double EstimateSeconds(const std::string& stage, const EstimateInput& input) {
  const double pixels = PixelsOfView(input), views = input.scene.views, proposals = ProposalsOf(input);
  double seconds = 0;
  if (stage == "register") {
    seconds = SecondsOfFeatures(input.photos);
  } else if (stage == "sfm") {
    seconds = SecondsOfFeatures(input.scene.views);
  } else if (stage == "depth") {
    seconds = kStereo + kStereoOfPixel * pixels * views;
  } else if (stage == "proxies") {
    seconds = SecondsOfProxies(input);
  } else if (stage == "propose") {
    seconds = kPropose + kProposeOfPixel * pixels * proposals;
  } else if (stage == "validate") {
    seconds = kValidate + kValidateOfPixel * pixels * proposals;
  } else if (stage == "train") {
    seconds = input.options.train.iterations.value() * SecondsOfIteration(input);
  } else if (stage == "evaluate") {
    seconds = 0.5 + 2 * SecondsOfRender(input) * std::max(input.scored_views, 1);
  } else if (stage == "report") {
    seconds = kReport + SecondsOfRender(input) * std::min(input.options.report.orbit_frames, kOrbitFrames);
  }
  return input.slowness * seconds;
}

int64_t EstimateRunMemory(const EstimateInput& input) {
  const double pixels = PixelsOfView(input);
  const double full = static_cast<double>(input.scene.largest.width) * input.scene.largest.height;
  const double held =
      kBytesOfViewPixel * pixels * input.scene.views + kBytesOfProposalPixel * pixels * ProposalsOf(input);
  const double loading = kBytesOfLoadedPixel * full * std::min(NumThreads(), input.scene.views);
  const double training = kBytesOfGaussian * input.options.train.max_gaussians.value() + kBytesOfWorkPixel * pixels;
  return static_cast<int64_t>(kProgramBytes + held + std::max(loading, training));
}

}  // namespace oraclegs
