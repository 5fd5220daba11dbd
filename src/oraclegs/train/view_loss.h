#pragma once
// What a run learns from, and what one view of it says about a render.

#include <optional>
#include <vector>

#include "oraclegs/loss/objective.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/exposure.h"
#include "oraclegs/train/options.h"
#include "oraclegs/train/train_view.h"
#include "oraclegs/train/view_sampler.h"

namespace oraclegs {

/// Photographs are certain; proposals count as far as their confidence says, in the mean exposure of the photographs.
struct TrainingData {
  // Not explicit: photographs alone are what most runs learn from.
  TrainingData(std::vector<TrainView> photographs_in = {}, std::vector<TrainView> proposals_in = {},
               PerceptualDistance lpips_in = {})
      : photographs(std::move(photographs_in)), proposals(std::move(proposals_in)), lpips(std::move(lpips_in)) {}

  std::vector<TrainView> photographs;
  std::vector<TrainView> proposals;
  PerceptualDistance lpips;  ///< of the proposals' loss; empty = there is no network
};

struct ViewLossResult {
  double loss = 0;
  RenderGrads grads;  ///< valid until the next view's
};

/// The views of a run at the sizes it sees them, and the loss of each:
/// - a photograph's: Objective::Photograph of the render through its exposure map, when those are trained, which then
///   learns from it;
/// - a proposal's: Objective::Proposal, through no map;
/// - of a view with inv_depth also depth_weight * 0.01^t * CharacteristicDepth * mean(|inv_depth - rendered| *
///   depth_mask) (docs/method.md#depth-term); proposal_weight is a factor of this too;
/// - of a view with alpha also alpha_weight * mean(|alpha - rendered| * confidence).
/// Iterations count from 1.
class ViewLoss {
 public:
  /// `options` are settled. Throws UsageError when there is no photograph or the shares of the loss sum to more than 1,
  /// ShapeError when a view does not fit; see CheckViews and CheckProposals.
  ViewLoss(const TrainOptions& options, TrainingData data);

  /// The view as an iteration sees it.
  const TrainView& View(const SampledView& sampled, int64_t iteration) const;

  /// out: the render of View(sampled, iteration). Throws RunError when the loss is not finite, before anything is
  /// learnt from it. The last iteration moves no exposure map.
  ViewLossResult operator()(const SampledView& sampled, int64_t iteration, const RenderOutput& out);

  const std::vector<TrainView>& photographs() const { return photographs_; }
  /// All views of a kind, at full size or as the coarse iterations see them; none of those without such iterations.
  const std::vector<TrainView>& Views(ViewKind kind, bool coarse) const;
  bool IsCoarse(int64_t iteration) const { return iteration <= coarse_iterations_; }
  /// Weight of mean(|inv_depth - rendered| depth_mask).
  double DepthTermWeight(ViewKind kind, int64_t iteration) const;
  const Objective& objective() const { return objective_; }
  const TrainOptions& options() const { return options_; }
  int num_photographs() const { return static_cast<int>(photographs_.size()); }
  int num_proposals() const { return static_cast<int>(proposals_.size()); }
  bool has_lpips() const { return objective_.has_lpips(); }
  /// nullptr where they are not trained.
  Exposures* exposures() { return exposures_ ? &*exposures_ : nullptr; }
  const Exposures* exposures() const { return exposures_ ? &*exposures_ : nullptr; }

 private:
  double PhotographLoss(int index, int64_t iteration, const Buffer<float>& image, Buffer<float>* grad);
  double DepthTerm(const TrainView& view, double weight, const Buffer<float>& inv_depth, Buffer<float>* grad);
  double AlphaTerm(const TrainView& view, const Buffer<float>& alpha, Buffer<float>* grad);

  TrainOptions options_;
  std::vector<TrainView> photographs_, proposals_;
  int64_t coarse_iterations_;
  std::vector<TrainView> half_photographs_, half_proposals_;  // none without coarse iterations
  double depth_scale_;  // of the depth term at the start of the run, world units; 0 = there is none
  std::optional<Exposures> exposures_;
  Objective objective_;
  ImageBuffer grad_image_, grad_inv_depth_, grad_alpha_, exposed_image_;
};

/// Throws RunError that names the iteration and the view when the loss is not finite.
void RequireFinite(double loss, int64_t iteration, const TrainView& view);

}  // namespace oraclegs
