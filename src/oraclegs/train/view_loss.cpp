#include "oraclegs/train/view_loss.h"

#include <cmath>
#include <utility>

#include "oraclegs/loss/masked_l1.h"
#include "oraclegs/train/coarse.h"
#include "oraclegs/train/schedule.h"

namespace oraclegs {
namespace {

std::vector<TrainView> CleanPhotographs(std::vector<TrainView> views) {
  CheckViews(views);
  for (TrainView& view : views) view = WithCleanDepth(std::move(view));
  return views;
}

/// As far as they are trusted.
std::vector<TrainView> CleanProposals(std::vector<TrainView> views, const TrainOptions& options) {
  CheckProposals(views);
  for (TrainView& view : views) {
    view = WithCleanDepth(WithGatedConfidence(std::move(view), options.confidence_gate, options.confidence_power));
  }
  return views;
}

std::vector<TrainView> HalfSizes(const std::vector<TrainView>& views, ViewKind kind) {
  std::vector<TrainView> halves;
  for (const TrainView& view : views) halves.push_back(HalfSize(view, kind));
  return halves;
}

std::vector<ExposureMap> StartExposures(const std::vector<TrainView>& views) {
  std::vector<ExposureMap> maps;
  for (const TrainView& view : views) maps.push_back(view.exposure);
  return maps;
}

/// The photographs say what distances the scene has; proposals only where no photograph knows any.
double SceneDepth(const std::vector<TrainView>& photographs, const std::vector<TrainView>& proposals) {
  const double depth = CharacteristicDepth(photographs);
  return depth > 0 ? depth : CharacteristicDepth(proposals);
}

ObjectiveWeights Weights(const TrainOptions& options) {
  return {options.ssim_weight, options.proposal_ssim, options.proposal_lpips, options.proposal_weight};
}

}  // namespace

ViewLoss::ViewLoss(const TrainOptions& options, TrainingData data)
    : options_(options),
      photographs_(CleanPhotographs(std::move(data.photographs))),
      proposals_(CleanProposals(std::move(data.proposals), options)),
      coarse_iterations_(CoarseIterations(options.coarse_share, options.iterations)),
      depth_scale_(options.depth_weight * SceneDepth(photographs_, proposals_)),
      objective_(Weights(options), std::move(data.lpips)) {
  if (coarse_iterations_ > 0) {
    half_photographs_ = HalfSizes(photographs_, ViewKind::kPhotograph);
    half_proposals_ = HalfSizes(proposals_, ViewKind::kProposal);
  }
  if (options.exposure == ExposureMode::kOn) exposures_.emplace(StartExposures(photographs_));
}

const TrainView& ViewLoss::View(const SampledView& sampled, int64_t iteration) const {
  return Views(sampled.kind, IsCoarse(iteration))[sampled.index];
}

const std::vector<TrainView>& ViewLoss::Views(ViewKind kind, bool coarse) const {
  if (kind == ViewKind::kProposal) return coarse ? half_proposals_ : proposals_;
  return coarse ? half_photographs_ : photographs_;
}

double ViewLoss::DepthTermWeight(ViewKind kind, int64_t iteration) const {
  const double weight = depth_scale_ * (kind == ViewKind::kProposal ? options_.proposal_weight : 1);
  return weight * DepthWeight(iteration, options_.iterations);
}

ViewLossResult ViewLoss::operator()(const SampledView& sampled, int64_t iteration, const RenderOutput& out) {
  const TrainView& view = View(sampled, iteration);
  const bool is_proposal = sampled.kind == ViewKind::kProposal;
  ViewLossResult result;
  result.grads.image = grad_image_.Get({view.camera.height, view.camera.width, 3});
  result.loss = is_proposal ? objective_.Proposal(out.image, view.image, view.confidence, &result.grads.image)
                            : PhotographLoss(sampled.index, iteration, out.image, &result.grads.image);
  result.loss += DepthTerm(view, DepthTermWeight(sampled.kind, iteration), out.inv_depth, &result.grads.inv_depth);
  result.loss += AlphaTerm(view, out.alpha, &result.grads.alpha);
  RequireFinite(result.loss, iteration, view);
  return result;
}

double ViewLoss::PhotographLoss(int index, int64_t iteration, const Buffer<float>& image, Buffer<float>* grad) {
  const TrainView& view = View({ViewKind::kPhotograph, index}, iteration);
  if (!exposures_) return objective_.Photograph(image, view.image, view.confidence, grad);
  const Buffer<float> exposed = exposed_image_.Get({view.camera.height, view.camera.width, 3});
  exposures_->Apply(index, image, exposed);
  double value = objective_.Photograph(exposed, view.image, view.confidence, grad);
  ExposureGradient gradient = exposures_->Backward(index, image, *grad);
  value += exposures_->AddPull(index, &gradient);
  RequireFinite(value, iteration, view);
  if (iteration < options_.iterations) {
    exposures_->Step(index, gradient, ExposureLearningRate(iteration, options_.iterations));
  }
  return value;
}

/// Leaves `grad` undefined, which the rasteriser takes for zero at no cost, where there is no depth to learn from.
double ViewLoss::DepthTerm(const TrainView& view, double weight, const Buffer<float>& inv_depth, Buffer<float>* grad) {
  if (weight == 0 || !view.inv_depth.defined()) return 0;
  *grad = grad_inv_depth_.Get({view.camera.height, view.camera.width});
  return MaskedL1(inv_depth, view.inv_depth, view.depth_mask, weight, grad);
}

/// Leaves `grad` undefined as DepthTerm does.
double ViewLoss::AlphaTerm(const TrainView& view, const Buffer<float>& alpha, Buffer<float>* grad) {
  if (options_.alpha_weight == 0 || !view.alpha.defined()) return 0;
  *grad = grad_alpha_.Get({view.camera.height, view.camera.width});
  return MaskedL1(alpha, view.alpha, view.confidence, options_.alpha_weight, grad);
}

void RequireFinite(double loss, int64_t iteration, const TrainView& view) {
  if (std::isfinite(loss)) return;
  throw RunError(
      "the loss is {} at iteration {} on {}: training has diverged; check the poses and the scale of the scene", loss,
      iteration, view.name);
}

}  // namespace oraclegs
