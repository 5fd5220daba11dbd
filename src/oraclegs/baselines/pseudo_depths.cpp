#include "oraclegs/baselines/pseudo_depths.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/baselines/pseudo_views.h"
#include "oraclegs/loss/depth_losses.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/loss_terms.h"

namespace oraclegs {

PseudoDepths::PseudoDepths(const BaselineSetup& setup)
    : options_(setup.options),
      settings_(setup.baseline),
      seed_(setup.seed),
      background_(setup.background),
      depth_(setup.pseudo_depth),
      views_(PseudoViewsBetween(Cameras(setup.data.photos), kPseudoViews, setup.seed)),
      rasterizer_(MakeRasterizer(kCpu)) {
  if (depth_) return;
  throw UsageError("depth between the photos needs their depth, and none is known; use another --depth-prior");
}

bool PseudoDepths::IsDue(const Iteration& iteration) const {
  const auto end = static_cast<int64_t>(kPseudoDepthEnd * options_.Horizon());
  return iteration.moves && iteration.number > settings_.pseudo_depth_start && iteration.number < end &&
         iteration.number % settings_.pseudo_depth_every == 0;
}

double PseudoDepths::BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients* grads) {
  if (!IsDue(iteration)) return 0;
  const auto since = static_cast<double>(iteration.number - settings_.pseudo_depth_start);
  const double weight = settings_.pseudo_depth_weight * std::min(1., since / kPseudoDepthRamp);
  const Camera& camera = DrawPseudoView(views_, seed_, iteration.number);
  const RenderOptions render{background_, iteration.sh_degree, options_.antialiased};
  const Device device = model->gaussians.device();
  const RenderOutput out = rasterizer_->Forward(model->gaussians, camera, render, RenderPass::kTrain);
  const Buffer<float> rendered = out.inv_depth.To(kCpu);
  Buffer<float> of_rendered = of_rendered_.Get(rendered.shape());
  double loss = 0;
  const Buffer<float> of_image = depth_(camera, out.image.To(kCpu), [&](const DepthTarget& target) {
    loss = PearsonDepthLoss({rendered, target.inv_depth, target.mask}, weight, &of_rendered);
    Buffer<float> of_target = of_target_.Get(rendered.shape());
    PearsonDepthLoss({target.inv_depth, rendered, target.mask}, weight, &of_target);
    return of_target;
  });
  if (!std::isfinite(loss)) {
    throw Diverged(
        "the depth of a pseudo view has a loss of {} at iteration {}: training has diverged; check the poses", loss,
        iteration.number);
  }
  if (grads_.size() != model->gaussians.size()) grads_ = Gaussians::Zeros(model->gaussians.size(), device);
  rasterizer_->Backward(model->gaussians, {of_image.To(device), {}, of_rendered.To(device)}, &grads_);
  grads->push_back(&grads_);
  return loss;
}

}  // namespace oraclegs
