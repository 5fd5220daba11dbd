#include "oraclegs/train/methods/pseudo_depths.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/loss/pearson_depth.h"
#include "oraclegs/render/make_rasterizer.h"
#include "oraclegs/train/baselines/pseudo_views.h"
#include "oraclegs/train/diverged.h"

namespace oraclegs {

PseudoDepths::PseudoDepths(const TrainSetup& setup)
    : options_(setup.options.Settled()),
      seed_(setup.seed),
      background_(setup.background),
      depth_(setup.pseudo_depth),
      views_(PseudoViewsBetween(Cameras(setup.data.photos), kPseudoViews, setup.seed)),
      rasterizer_(MakeRasterizer(kCpu)) {
  if (depth_) return;
  throw UsageError(
      "--pseudo-depth-weight needs depth, and none is known; use another --depth-prior or leave the weight out");
}

bool PseudoDepths::IsDue(const Iteration& iteration) const {
  const BaselineOptions& baseline = options_.baseline;
  const auto end = static_cast<int64_t>(kPseudoDepthEnd * options_.Horizon());
  return iteration.moves && iteration.number > baseline.pseudo_depth_start && iteration.number < end &&
         iteration.number % baseline.pseudo_depth_every == 0;
}

double PseudoDepths::BeforeView(const Iteration& iteration, TrainedModel* model, Gaussians* grads) {
  if (!IsDue(iteration)) return 0;
  const BaselineOptions& baseline = options_.baseline;
  const auto since = static_cast<double>(iteration.number - baseline.pseudo_depth_start);
  const double weight = baseline.pseudo_depth_weight * std::min(1., since / kPseudoDepthRamp);
  const Camera& camera = DrawPseudoView(views_, seed_, iteration.number);
  const RenderOptions render{background_, iteration.sh_degree, options_.antialiased};
  const RenderOutput out = rasterizer_->Forward(model->gaussians, camera, render, RenderPass::kTrain);
  RenderGrads upstream{{}, {}, of_rendered_.Get(out.inv_depth.shape())};
  double loss = 0;
  upstream.image = depth_(camera, out.image, [&](const DepthTarget& target) {
    loss = PearsonDepthLoss({out.inv_depth, target.inv_depth, target.mask}, weight, &upstream.inv_depth);
    Buffer<float> of_target = of_target_.Get(out.inv_depth.shape());
    PearsonDepthLoss({target.inv_depth, out.inv_depth, target.mask}, weight, &of_target);
    return of_target;
  });
  if (!std::isfinite(loss)) {
    throw Diverged(
        "the depth of a pseudo view has a loss of {} at iteration {}: training has diverged; check the poses", loss,
        iteration.number);
  }
  if (grads_.size() != model->gaussians.size()) grads_ = Gaussians::Zeros(model->gaussians.size());
  rasterizer_->Backward(model->gaussians, upstream, &grads_);
  AddGaussians(grads_, grads);
  return loss;
}

}  // namespace oraclegs
