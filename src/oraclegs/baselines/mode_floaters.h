#pragma once
// Floater pruning of SparseGS [Xiong 2023] (its section on advanced floater pruning): where the Gaussian of the largest
// blending weight of a pixel lies far before the blended depth, it and all before it are taken to be floaters. The
// threshold follows from how bimodal the differences are. Constants and details are those of the public code.

#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/baselines/ray_modes.h"

namespace oraclegs {

struct ModeFloaterOptions {
  double percentile = 98;       ///< percentile of a view's positive differences that is the threshold at a dip of 0
  double dip_rate = 7.5;        ///< the percentile is percentile * exp(-dip_rate * dip). Also published: 7
  double min_percentile = 80;   ///< lower bound of the percentile
  double min_log_falloff = -4;  ///< Gaussians whose log falloff at a pixel is below this are no floaters of it
};

/// (blended - mode) / (blended + c) of each pixel, where c is the larger of the least blended depth and their mean less
/// three standard deviations (n - 1). Empty pixels have depth 0. A quotient that is not a number becomes 0.
std::vector<float> ModeDifferences(const RayModes& modes);

/// max(min_percentile, percentile * exp(-dip_rate * mean_dip)). mean_dip: mean over the views of the dip of their
/// positive differences.
double FloaterPercentile(double mean_dip, const ModeFloaterOptions& options);

/// 1 for each Gaussian to prune: one that RayView::MarkUpToMode marks in any view at a pixel whose difference is above
/// the percentile (linearly interpolated) of the view's positive differences. SparseGS prunes once, after iteration
/// 20000 of 30000. The result does not depend on the number of threads. Throws ShapeError as RayView.
std::vector<uint8_t> FindModeFloaters(const Gaussians& gaussians, const std::vector<Camera>& cameras,
                                      const RenderOptions& render, const ModeFloaterOptions& options);

/// Opacity logit of removed Gaussians: below what any render shows, so that no gradient reaches them again.
inline constexpr float kRemovedLogit = -20;

/// Runs before the view of iteration prune_modes_at: Gaussians that FindModeFloaters finds from the photos' cameras
/// get kRemovedLogit and opacity moments of 0. The next refinement removes them with adaptive density control and
/// relocates them with 3DGS-MCMC; without one, as in the published schedule, they stay in the model and are invisible.
class PruneModes final : public MethodPart {
 public:
  explicit PruneModes(const BaselineSetup& setup);

  /// Adds no gradient, returns 0.
  double BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients* grads) override;

 private:
  int at_;
  bool antialiased_;
  std::array<float, 3> background_;
  std::vector<Camera> cameras_;
};

// Hartigan's dip, a number for how far a sample is from having one mode.

/// The dip of a sample [Hartigan 1985]: the largest difference between its distribution function and the unimodal one
/// that comes closest. Between 1 / (2 n), for samples of one mode, and 1/4, for two equal heaps; 0 for an empty sample.
/// Numbers must be finite; they are sorted. O(n log n).
double DipStatistic(std::vector<float> sample);

}  // namespace oraclegs
