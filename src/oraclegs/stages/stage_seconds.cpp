#include "oraclegs/stages/stage_seconds.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/depth/stereo_setup.h"
#include "oraclegs/settings/from_results.h"
#include "oraclegs/settings/plan.h"
#include "oraclegs/sfm/choose_pairs.h"
#include "oraclegs/sfm/colmap_runner.h"

namespace oraclegs {
namespace {

// Seconds on the reference machine.
constexpr double kExtract = 0.2, kExtractOfPixel = 0.47e-6;  // a photo
constexpr double kMatch = 0.04, kMatchOfSide = 0.22e-3;      // a pair; features grow with the pixels' square root
constexpr double kIterationOfPixel = 59e-9, kIterationOfGaussian = 107e-9, kIteration = 0.5e-3;
constexpr double kScoreOfPixel = 0.75e-6, kLoadOfPixel = 26e-9;  // of an image as it came
constexpr int kPhotosThatLeaveLittle = 80;                       // open, usually; only depth can say
constexpr double kRenderOfPixel = 0.1e-6, kRenderOfGaussian = 30e-9;

}  // namespace

double PixelsOfView(const EstimateInput& input) {
  const PixelSize size = WorkingSize(input.scene.largest, input.options.image.Settled());
  return static_cast<double>(size.width) * size.height;
}

double CoveredPixels(const EstimateInput& input) { return input.covered * PixelsOfView(input); }

double FullPixels(const EstimateInput& input) {
  return static_cast<double>(input.scene.largest.width) * input.scene.largest.height;
}

int ProposalsOf(const EstimateInput& input) {
  const RunOptions& options = input.options;
  if (!ProposesViews(options)) return 0;
  const double openness = input.scene.views > kPhotosThatLeaveLittle ? 0 : 1;
  const TargetPlan targets =
      SettleTargets(options.trajectory, options.propose.ByProxiesAlone(), {input.scene.views, openness});
  const bool has_spare = static_cast<size_t>(input.other_views) >= kMinSpareForDataset;
  const bool at_views = targets.trajectory == Trajectory::kDataset && (has_spare || !targets.or_coverage);
  return at_views ? std::min(targets.count, input.other_views) : targets.count;
}

double SecondsOfIteration(const EstimateInput& input) {
  return kIteration + kIterationOfPixel * CoveredPixels(input) +
         kIterationOfGaussian * input.options.train.max_gaussians.value();
}

double SecondsOfFeatures(const EstimateInput& input, int photos) {
  const int side = std::max(input.scene.largest.width, input.scene.largest.height);
  const double reduction = std::min(1.0, static_cast<double>(kMaxFeatureImageSide) / side);
  const double pixels = FullPixels(input) * reduction * reduction;
  return (kExtract + kExtractOfPixel * pixels) * photos +
         (kMatch + kMatchOfSide * std::sqrt(pixels)) * static_cast<double>(PairsToMatch(photos));
}

double SecondsOfStereo(const EstimateInput& input) {
  constexpr double kSearchOfPixel = 3.4e-6, kPassOfPixel = 6.8e-6;
  const int passes = input.options.stereo.Settled().geometric_passes;
  const double of_pixel = kSearchOfPixel + kPassOfPixel * passes;
  return of_pixel * CoveredPixels(input) * std::min<double>(input.scene.views, kMaxStereoViews);
}

double SecondsOfScores(const EstimateInput& input, double views) {
  return (kScoreOfPixel * CoveredPixels(input) + kLoadOfPixel * FullPixels(input)) * views;
}

double SecondsOfRender(const EstimateInput& input) {
  return kRenderOfPixel * CoveredPixels(input) + kRenderOfGaussian * input.options.train.max_gaussians.value();
}

}  // namespace oraclegs
