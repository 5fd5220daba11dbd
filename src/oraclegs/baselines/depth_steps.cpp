#include "oraclegs/baselines/depth_steps.h"

#include <algorithm>
#include <utility>

#include "oraclegs/render/render.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {
namespace {

/// The Gaussians with hard opacities; shares the other buffers.
Gaussians WithHardOpacity(const Gaussians& gaussians) {
  Gaussians hard = gaussians;
  hard.opacity_logits =
      Buffer<float>::Full({gaussians.size()}, static_cast<float>(LogitOf(kHardOpacity))).To(gaussians.device());
  return hard;
}

/// Adds the weighted loss of one normalization to `loss` and its gradient to `grad`.
double AddDepthLoss(const DepthImages& images, const NormalizedDepthOptions& options, double weight,
                    const Buffer<float>& grad) {
  Buffer<float> more = Buffer<float>::Empty(grad.shape());
  const double loss = NormalizedDepthLoss(images, options, weight, &more);
  for (int64_t i = 0; i < more.count(); ++i) grad[i] += more[i];
  return loss;
}

}  // namespace

std::vector<TrainView> DepthAlone(const std::vector<TrainView>& photos) {
  CheckViews(photos);
  std::vector<TrainView> views;
  for (const TrainView& photo : photos) {
    views.push_back(WithCleanDepth(photo));
    views.back().image = views.back().pixel_weight = views.back().alpha = {};
  }
  return views;
}

DepthSteps::DepthSteps(const BaselineSetup& setup)
    : options_(setup.options),
      settings_(setup.baseline),
      photos_(DepthAlone(setup.data.photos)),
      rasterizer_(MakeRasterizer(kCpu)) {
  const auto has_depth = [](const TrainView& photo) { return photo.inv_depth.defined(); };
  if (std::any_of(photos_.begin(), photos_.end(), has_depth)) return;
  throw UsageError("steps by depth need the depth of the photos, none is known; use another --depth-prior");
}

bool DepthSteps::IsDue(const Iteration& iteration) const {
  return iteration.moves && iteration.view.kind == ViewKind::kPhoto &&
         iteration.number % settings_.depth_step_every == 0 &&
         static_cast<double>(iteration.number) < options_.refine_stop * static_cast<double>(options_.Horizon());
}

const Gaussians& DepthSteps::Gradient(const Gaussians& gaussians, const TrainView& photo, const Iteration& iteration,
                                      uint64_t patch_seed) {
  // Colors are unused: degree 0 is the cheapest.
  const RenderOptions render{{0, 0, 0}, 0, options_.antialiased};
  const RenderOutput out = rasterizer_->Forward(gaussians, photo.camera, render, RenderPass::kTrain);
  const Buffer<float> rendered = out.inv_depth.To(kCpu);
  grad_inv_depth_ = Buffer<float>::Zeros(rendered.shape());
  double loss = 0;
  for (const DepthNormalization normalization : {DepthNormalization::kLocal, DepthNormalization::kGlobal}) {
    const bool is_local = normalization == DepthNormalization::kLocal;
    const NormalizedDepthOptions options{normalization, DrawPatchSide({}, normalization, patch_seed, iteration.number),
                                         settings_.depth_tolerance};
    loss += AddDepthLoss({rendered, photo.inv_depth, photo.depth_mask}, options,
                         is_local ? kLocalDepthWeight : kGlobalDepthWeight, grad_inv_depth_);
  }
  RequireFinite(loss, iteration.number, photo);
  if (grads_.size() != gaussians.size()) grads_ = Gaussians::Zeros(gaussians.size(), gaussians.device());
  rasterizer_->Backward(gaussians, {{}, {}, grad_inv_depth_.To(gaussians.device())}, &grads_);
  return grads_;
}

double DepthSteps::BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients*) {
  if (!IsDue(iteration)) return 0;
  const TrainView& photo = photos_[static_cast<size_t>(iteration.view.index)];
  if (!photo.inv_depth.defined()) return 0;
  Gaussians* gaussians = &model->gaussians;
  if (settings_.hard_depth) {
    const Gaussians& grads = Gradient(WithHardOpacity(*gaussians), photo, iteration, iteration.seed);
    model->adam.StepGroup(&Gaussians::means, grads, iteration.rates.means, gaussians);
  }
  if (settings_.soft_depth_start > 0 && iteration.number > settings_.soft_depth_start) {
    const Gaussians& grads = Gradient(*gaussians, photo, iteration, iteration.seed + kSoftPatchSeed);
    model->adam.StepGroup(&Gaussians::opacity_logits, grads, iteration.rates.opacity_logits, gaussians);
  }
  return 0;
}

}  // namespace oraclegs
