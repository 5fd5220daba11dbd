#include "oraclegs/run/time_estimate.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/settings/plan.h"
#include "oraclegs/sfm/choose_pairs.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "oraclegs/stages/proxy_models.h"

namespace oraclegs {
namespace {

// Seconds on the reference machine.
constexpr double kFeatures = 0.2, kFeaturesOfPixel = 0.47e-6;  // a photo
constexpr double kMatch = 0.04, kMatchOfSide = 0.22e-3;        // a pair; features grow with the side
constexpr double kMapping = 3, kMappingOfPhoto = 0.3, kTriangulation = 0.5, kReuse = 0.3;
constexpr double kStereoOfPixel = 17e-6, kStereo = 0.5;
constexpr double kIterationOfPixel = 59e-9, kIterationOfGaussian = 107e-9, kIteration = 0.5e-3;
constexpr double kProposeOfPixel = 0.35e-6, kPropose = 1;
constexpr double kValidateOfPixel = 1.35e-6, kTeachOracleOfPixel = 5e-6, kValidate = 0.5;
constexpr double kScoreOfPixel = 0.75e-6, kScore = 0.5, kLoadOfPixel = 26e-9;  // for an image before resizing
constexpr double kReport = 0.5, kReportOfPixel = 1e-6, kRenderOfPixel = 0.1e-6, kRenderOfGaussian = 30e-9;
constexpr int kOrbitFrames = 96;

// Bytes.
constexpr double kProgramBytes = 150e6, kBytesOfGaussian = 1100, kBytesOfViewPixel = 34, kBytesOfProposalPixel = 24,
                 kBytesOfWorkPixel = 170, kBytesOfLoadedPixel = 44;

double PixelsOfView(const EstimateInput& input) {
  const PixelSize size = WorkingSize(input.scene.largest, input.options.image);
  return static_cast<double>(size.width) * size.height;
}

double CoveredPixels(const EstimateInput& input) { return input.covered * PixelsOfView(input); }

/// Pixels of an image before resizing.
double FullPixels(const EstimateInput& input) {
  return static_cast<double>(input.scene.largest.width) * input.scene.largest.height;
}

int ProposalsOf(const EstimateInput& input) {
  const RunOptions& options = input.options;
  if (!ProposesViews(options)) return 0;
  const int proposals =
      options.trajectory.proposals.ValueOr(options.propose.ByProxiesAlone() ? kProxyProposals : kUsualProposals);
  const bool has_spare = static_cast<size_t>(input.other_views) >= kMinSpareForDataset;
  const auto& trajectory = options.trajectory.trajectory;
  const bool at_views = trajectory.is_auto() ? has_spare : trajectory.value() == Trajectory::kDataset;
  return at_views ? std::min(proposals, input.other_views) : proposals;
}

double SecondsOfIteration(const EstimateInput& input) {
  return kIteration + kIterationOfPixel * CoveredPixels(input) +
         kIterationOfGaussian * input.options.train.max_gaussians.value();
}

/// Seconds for COLMAP's features; COLMAP reduces photos to at most kMaxFeatureImageSide pixels.
double SecondsOfFeatures(const EstimateInput& input, int photos) {
  const int side = std::max(input.scene.largest.width, input.scene.largest.height);
  const double reduction = std::min(1.0, static_cast<double>(kMaxFeatureImageSide) / side);
  const double pixels = FullPixels(input) * reduction * reduction;
  return (kFeatures + kFeaturesOfPixel * pixels) * photos +
         (kMatch + kMatchOfSide * std::sqrt(pixels)) * static_cast<double>(PairsToMatch(photos));
}

double SecondsOfProxies(const EstimateInput& input) {
  const ProposeOptions& propose = input.options.propose;
  if (!propose.Uses(ProposerChoice::kSplat)) return 0;
  const bool is_object = input.covered < 1;
  const double iterations =
      (propose.proxy_share + propose.ProxyFinish(is_object)) * input.options.train.iterations.value();
  return ProxyCount(propose, input.scene.views) * iterations * SecondsOfIteration(input);
}

double SecondsOfRender(const EstimateInput& input) {
  return kRenderOfPixel * CoveredPixels(input) + kRenderOfGaussian * input.options.train.max_gaussians.value();
}

}  // namespace

double EstimateSeconds(const std::string& stage, const EstimateInput& input) {
  const double pixels = CoveredPixels(input), views = input.scene.views, proposals = ProposalsOf(input);
  double seconds = 0;
  if (stage == "register") {
    seconds = SecondsOfFeatures(input, input.photos) + kMapping + kMappingOfPhoto * input.photos;
  } else if (stage == "sfm") {
    const bool found = input.photos > 0 && input.test_views + input.other_views == 0;  // registration made all points
    seconds = found ? kReuse : SecondsOfFeatures(input, input.scene.views) + kTriangulation;
  } else if (stage == "depth") {
    seconds = kStereo + kStereoOfPixel * pixels * views;
  } else if (stage == "proxies") {
    seconds = SecondsOfProxies(input);
  } else if (stage == "propose") {
    seconds = kPropose + kProposeOfPixel * pixels * proposals;
  } else if (stage == "validate") {
    seconds = kValidate + kValidateOfPixel * pixels * proposals + kTeachOracleOfPixel * pixels * views;
  } else if (stage == "train") {
    seconds = input.options.train.iterations.value() * SecondsOfIteration(input);
  } else if (stage == "evaluate") {
    const double scored = input.test_views > 0 ? input.test_views : views;
    seconds = kScore + (kScoreOfPixel * pixels + kLoadOfPixel * FullPixels(input)) * scored;
  } else if (stage == "report") {
    seconds = kReport + (kReportOfPixel * pixels + kLoadOfPixel * FullPixels(input)) * (views + input.test_views) +
              SecondsOfRender(input) * std::min(input.options.report.orbit_frames, kOrbitFrames);
  }
  return input.slowness * seconds;
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
