#include "oraclegs/train/view_loss.h"

#include "oraclegs/loss/depth_losses.h"

namespace oraclegs {

/// A render and the view it is compared with.
struct ViewLoss::Rendered {
  const TrainView& view;
  const RenderOutput& out;
  const Buffer<float>& shown;   // the image through the exposure map
  std::optional<int> exposure;  // number of the map
};

ViewLoss::ViewLoss(const LossPlan& plan) : plan_(plan) {
  if (const auto start = plan.StartExposures(); !start.empty()) exposures_.emplace(start);
}

Buffer<float> ViewLoss::PlaneOf(const TrainView& view, ViewPlane plane) {
  switch (plane) {
    case ViewPlane::kImage:
      if (!view.image_bytes.defined()) return view.image;
      UnpackBytes(view.image_bytes, image_.Get(view.image_bytes.shape()));
      return image_.Get(view.image_bytes.shape());
    case ViewPlane::kPixelWeight:
      if (!view.weight_bytes.defined()) return view.pixel_weight;
      UnpackBytes(view.weight_bytes, weights_.Get(view.weight_bytes.shape()));
      return weights_.Get(view.weight_bytes.shape());
    case ViewPlane::kInvDepth:
      return view.inv_depth;
    case ViewPlane::kDepthMask:
      return view.depth_mask;
    case ViewPlane::kAlpha:
      return view.alpha;
    case ViewPlane::kNone:
      break;
  }
  return {};
}

ViewLossResult ViewLoss::operator()(const SampledView& sampled, int64_t iteration, const RenderOutput& out) {
  const TrainView& view = plan_.View(sampled);
  const LossTerms terms = plan_.Terms(sampled, iteration);
  ViewLossResult result;
  result.grads.image = grad_image_.Get({view.camera.height, view.camera.width, 3});
  Buffer<float> shown = out.image;
  if (terms.exposure) {
    shown = exposed_image_.Get({view.camera.height, view.camera.width, 3});
    exposures_->Apply(*terms.exposure, out.image, shown);
  }
  const Rendered rendered{view, out, shown, terms.exposure};
  for (const LossTerm& term : terms) result.loss += Evaluate(term, rendered, &result);
  RequireFinite(result.loss, iteration, view);
  if (terms.exposure_rate > 0) exposures_->Step(*terms.exposure, exposure_gradient_, terms.exposure_rate);
  return result;
}

double ViewLoss::Evaluate(const LossTerm& term, const Rendered& rendered, ViewLossResult* result) {
  RenderGrads* grads = &result->grads;
  const TrainView& view = rendered.view;
  const Buffer<float> target = PlaneOf(view, term.target), mask = PlaneOf(view, term.mask);
  switch (term.kind) {
    case TermKind::kPhotometric:
      result->photometric =
          photometric_(rendered.shown, target, {mask, term.mask_meaning}, term.photometric, &grads->image);
      return result->photometric.loss;
    case TermKind::kExposure:
      exposure_gradient_ = exposures_->Backward(*rendered.exposure, rendered.out.image, grads->image);
      return exposures_->AddRegularizer(*rendered.exposure, term.weight, &exposure_gradient_);
    case TermKind::kPerceptual:
      return term.weight * plan_.lpips()(rendered.out.image, target, term.weight, &grads->image);
    case TermKind::kInvDepth:
      grads->inv_depth = grad_inv_depth_.Get({view.camera.height, view.camera.width});
      return result->depth = MaskedL1(rendered.out.inv_depth, target, mask, term.weight, &grads->inv_depth);
    case TermKind::kAlpha:
      grads->alpha = grad_alpha_.Get({view.camera.height, view.camera.width});
      return result->alpha = MaskedL1(rendered.out.alpha, target, mask, term.weight, &grads->alpha);
  }
  return 0;
}

}  // namespace oraclegs
