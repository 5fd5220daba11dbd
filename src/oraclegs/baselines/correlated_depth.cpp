#include "oraclegs/baselines/correlated_depth.h"

#include "oraclegs/baselines/depth_steps.h"
#include "oraclegs/loss/depth_losses.h"

namespace oraclegs {
namespace {

constexpr double kLateShare = 0.95;  // FSGS lowers its weight after 9500 of 10000 iterations

void AddTo(const Buffer<float>& from, const Buffer<float>& to) {
  for (int64_t i = 0; i < to.count(); ++i) to[i] += from[i];
}

}  // namespace

CorrelatedDepth::CorrelatedDepth(const BaselineSetup& setup)
    : settings_(setup.baseline), horizon_(setup.options.Horizon()), photos_(DepthAlone(setup.data.photos)) {}

double CorrelatedDepth::OnView(const Iteration& iteration, const RenderOutput& out, RenderGrads* grads) {
  if (iteration.view.kind != ViewKind::kPhoto) return 0;
  const TrainView& photo = photos_[static_cast<size_t>(iteration.view.index)];
  if (!photo.inv_depth.defined()) return 0;
  const bool is_late = static_cast<double>(iteration.number) > kLateShare * static_cast<double>(horizon_);
  const DepthImages images{out.inv_depth.To(kCpu), photo.inv_depth, photo.depth_mask};
  Buffer<float> gradient = gradient_.Get(photo.inv_depth.shape());
  double loss =
      PearsonDepthLoss(images, settings_.depth_correlation * (is_late ? settings_.late_correlation : 1), &gradient);
  if (settings_.patched_correlation > 0) {
    Buffer<float> more = of_patches_.Get(photo.inv_depth.shape());
    more.SetZero();
    const std::vector<ImagePatch> patches =
        RandomPatches(photo.camera.height, photo.camera.width, {}, iteration.seed, iteration.number);
    loss += PatchPearsonDepthLoss(images, patches, settings_.patched_correlation, &more);
    AddTo(more, gradient);
  }
  RequireFinite(loss, iteration.number, photo);
  if (grads->inv_depth.defined()) AddTo(grads->inv_depth.To(kCpu), gradient);
  grads->inv_depth = gradient.To(out.inv_depth.device());
  return loss;
}

}  // namespace oraclegs
