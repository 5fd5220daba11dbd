#include "oraclegs/train/cpu_train_device.h"

#include "oraclegs/train/floaters.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/rows.h"
#include "oraclegs/train/scale_cap.h"

namespace oraclegs {
namespace {

class CpuTrainDevice final : public TrainDevice {
 public:
  explicit CpuTrainDevice(const TrainDeviceSetup& setup)
      : options_(setup.options), view_loss_(*setup.view_loss), rasterizer_(MakeRasterizer(kCpu)) {}

  Rasterizer& rasterizer() override { return *rasterizer_; }
  RenderTimings TimingsSoFar() const override { return rasterizer_->timings(); }

  TrainedModel Upload(const TrainedModel& host) override {
    if (host.adam.m.size() > 0) return Copy(host);
    return {Clone(host.gaussians), Adam(host.gaussians.size())};
  }
  TrainedModel Download(const TrainedModel& model) const override { return Copy(model); }

  Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) override {
    if (!opacity_factors_.defined() || opacity_factors_.count() != n) {
      opacity_factors_ = Buffer<float>::Empty({n});
    }
    DrawOpacityFactors(perturbation, opacity_factors_);
    return opacity_factors_;
  }

  RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) override {
    const ViewLossResult result = view_loss_(iteration.view, iteration.number, out);
    loss_of_view_ = result.loss;
    return result.grads;
  }

  /// Block by block: gradients are used up while they are in the cache.
  void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) override {
    Gaussians* gaussians = &model->gaussians;
    regularizers_.Begin(*gaussians, options_.opacity_reg, options_.scale_reg);
    if (iteration.moves) {
      const AdamStep step = model->adam.BeginStep(iteration.rates, iteration.sh_degree, gaussians);
      const MeansNoise noise{iteration.seed, iteration.number, iteration.rates.means};
      const bool add_noise = !iteration.refines;  // else it comes after relocation and growth
      rasterizer_->BackwardBlocks(*gaussians, upstream, [&](int64_t begin, int64_t end, const GaussianRows& grads) {
        regularizers_.AddTo(begin, end, grads);
        step.Update(begin, end, grads);
        if (add_noise) AddNoiseToBlock(noise, begin, end, gaussians);
      });
    } else {
      rasterizer_->BackwardBlocks(*gaussians, upstream, [&](int64_t begin, int64_t end, const GaussianRows& grads) {
        regularizers_.AddTo(begin, end, grads);
      });
    }
    const double loss = loss_of_view_ + regularizers_.Value();
    RequireFinite(loss, iteration.number, view_loss_.View(iteration.view, iteration.number));
    loss_.last = loss;
    loss_.smoothed = iteration.number == 1 ? loss : kLossSmoothing * loss_.smoothed + (1 - kLossSmoothing) * loss;
  }

  void CapScales(TrainedModel* model) override {
    oraclegs::CapScales(camera_centers_, options_.largest_scale, &model->gaussians);
  }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    Gaussians* gaussians = &model->gaussians;
    if (options_.prune_floaters) PruneFloaters(view_loss_.photographs(), gaussians);
    RelocateDead(iteration.seed, iteration.number, gaussians, &model->adam);
    AddGaussians(iteration.seed, iteration.number, options_.max_gaussians, gaussians, &model->adam);
    AddNoise({iteration.seed, iteration.number, iteration.rates.means}, gaussians);
  }

  LossReport Loss() override { return loss_; }
  void RestoreLoss(double smoothed) override { loss_ = {0, smoothed}; }

  ExposureState exposures() const override {
    const Exposures* exposures = std::as_const(view_loss_).exposures();
    return exposures == nullptr ? ExposureState() : exposures->state();
  }
  void RestoreExposures(const ExposureState& state) override {
    if (Exposures* exposures = view_loss_.exposures()) exposures->Restore(state);
  }

 private:
  static TrainedModel Copy(const TrainedModel& model) {
    TrainedModel copy = model;
    for (Gaussians* group : {&copy.gaussians, &copy.adam.m, &copy.adam.v}) *group = Clone(*group);
    return copy;
  }

  TrainOptions options_;
  ViewLoss& view_loss_;
  std::unique_ptr<Rasterizer> rasterizer_;
  std::vector<float> camera_centers_ = CameraCenters(view_loss_.photographs());
  Regularizers regularizers_;
  Buffer<float> opacity_factors_;  // [N]
  double loss_of_view_ = 0;
  LossReport loss_;
};

}  // namespace

std::unique_ptr<TrainDevice> MakeCpuTrainDevice(const TrainDeviceSetup& setup) {
  return std::make_unique<CpuTrainDevice>(setup);
}

}  // namespace oraclegs
