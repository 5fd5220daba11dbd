#include "oraclegs/train/train_device.h"

#include <optional>
#include <utility>

#include "oraclegs/core/cuda_library.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/method_part.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/outliers.h"
#include "oraclegs/train/regularizers.h"
#include "oraclegs/train/view_loss.h"

namespace oraclegs {
namespace {

/// Steps a block of Gaussians while its gradients are in the cache.
struct StepConsumer final : GradientConsumer {
  const Iteration& iteration;
  Gaussians* gaussians;
  Regularizers* regularizers;
  std::optional<AdamStep> step;  // nothing: Gaussians stay, only the regularizers' value is wanted
  bool adds_noise = false;
  const PartGradients* parts = nullptr;

  StepConsumer(const Iteration& iteration_in, Gaussians* gaussians_in, Regularizers* regularizers_in)
      : iteration(iteration_in), gaussians(gaussians_in), regularizers(regularizers_in) {}

  void ConsumeBlock(int64_t begin, int64_t end, const GaussianRows& grads) override {
    regularizers->AddTo(begin, end, grads);
    for (const Gaussians* part : *parts) AddRows(*part, begin, end, 3 * ShCount(iteration.sh_degree), grads);
    if (!step) return;
    step->Update(begin, end, grads);
    if (!adds_noise) return;
    AddNoiseToBlock({iteration.seed, iteration.number, iteration.rates.means}, begin, end, gaussians);
  }
};

class CpuTrainDevice final : public TrainDevice {
 public:
  explicit CpuTrainDevice(const TrainDeviceSetup& setup)
      : options_(setup.options),
        plan_(setup.plan),
        parts_(setup.parts),
        view_loss_(plan_),
        rasterizer_(MakeRasterizer(kCpu)) {
    const DensifierSetup densifier{options_, plan_, rasterizer_.get()};
    densifier_ = setup.densifier ? setup.densifier(densifier) : MakeMcmcDensifier(densifier);
    densifier_->Begin(setup.start);
    for (const std::shared_ptr<MethodPart>& part : parts_) part->Attach(*this);
  }

  Rasterizer& rasterizer() override { return *rasterizer_; }
  RenderTimings TimingsSoFar() const override { return rasterizer_->timings(); }
  std::unique_ptr<Rasterizer> NewRasterizer() const override { return MakeRasterizer(kCpu); }

  TrainedModel Upload(const TrainedModel& host) override {
    if (host.adam.size() > 0) return {host.gaussians.Clone(), host.adam.Clone()};
    return {host.gaussians.Clone(), Adam(host.gaussians.size(), options_.sh_moments)};
  }
  TrainedModel Download(const TrainedModel& model) const override {
    return {model.gaussians.Clone(), model.adam.Clone()};
  }

  void RunParts(const Iteration& iteration, TrainedModel* model) override {
    part_gradients_.clear();
    loss_of_parts_ = oraclegs::RunParts(parts_, iteration, densifier_.get(), model, &part_gradients_);
  }

  Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) override {
    if (!opacity_factors_.defined() || opacity_factors_.count() != n) {
      opacity_factors_ = Buffer<float>::Empty({n});
    }
    DrawOpacityFactors(perturbation, opacity_factors_);
    return opacity_factors_;
  }

  RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) override {
    ViewLossResult result = view_loss_(iteration.view, iteration.number, out);
    loss_of_view_ = result.loss;
    AddTerms(iteration.view.kind, result);
    for (const std::shared_ptr<MethodPart>& part : parts_) {
      loss_of_parts_ += part->OnView(iteration, out, &result.grads);
    }
    return result.grads;
  }

  void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) override {
    Gaussians* gaussians = &model->gaussians;
    regularizers_.Begin(*gaussians, {options_.opacity_reg, options_.scale_reg});
    StepConsumer consumer(iteration, gaussians, &regularizers_);
    const bool adds_noise = densifier_->AddsNoise();
    // In an iteration that refines the noise comes after relocation and growth.
    consumer.adds_noise = adds_noise && !iteration.refines;
    consumer.parts = &part_gradients_;
    if (iteration.moves && (adds_noise || !iteration.refines)) {
      consumer.step = model->adam.BeginStep(iteration.rates, iteration.sh_degree, gaussians);
    }
    rasterizer_->BackwardInto(*gaussians, upstream, &consumer);
    const double loss = loss_of_view_ + loss_of_parts_ + regularizers_.Value();
    terms_.regularization += regularizers_.Value();
    RequireFinite(loss, iteration.number, plan_.View(iteration.view));
    loss_.last = loss;
    loss_.smoothed = iteration.number == 1 ? loss : kLossSmoothing * loss_.smoothed + (1 - kLossSmoothing) * loss;
  }

  void CapScales(TrainedModel* model) override {
    oraclegs::CapScales(camera_centers_, options_.largest_scale, &model->gaussians);
  }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    if (densifier_->Acts(iteration)) densifier_->Refine(iteration, model);
  }
  Densifier& densifier() override { return *densifier_; }

  LossReport Loss() override { return loss_; }
  void RestoreLoss(double smoothed) override { loss_ = {0, smoothed}; }
  TermSums Terms() const override { return terms_; }

  ExposureState exposures() const override {
    const Exposures* exposures = view_loss_.exposures();
    return exposures == nullptr ? ExposureState() : exposures->state();
  }
  void RestoreExposures(const ExposureState& state) override {
    if (Exposures* exposures = view_loss_.exposures()) exposures->Restore(state);
  }

 private:
  void AddTerms(ViewKind kind, const ViewLossResult& result) {
    if (kind == ViewKind::kProposal) {
      ++terms_.proposals;
      terms_.proposal += result.loss;
      return;
    }
    ++terms_.photos;
    terms_.l1 += result.photometric.l1, terms_.dssim += result.photometric.dssim;
    terms_.depth += result.depth, terms_.alpha += result.alpha;
  }

  TrainOptions options_;
  const LossPlan& plan_;
  MethodParts parts_;
  ViewLoss view_loss_;
  std::unique_ptr<Rasterizer> rasterizer_;
  std::unique_ptr<Densifier> densifier_;  // watches the rasterizer
  std::vector<float> camera_centers_ = CameraCenters(plan_.photos());
  Regularizers regularizers_;
  Buffer<float> opacity_factors_;  // [N]
  PartGradients part_gradients_;   // of one iteration
  double loss_of_view_ = 0, loss_of_parts_ = 0;
  LossReport loss_;
  TermSums terms_;
};

}  // namespace

std::unique_ptr<TrainDevice> MakeCpuTrainDevice(const TrainDeviceSetup& setup) {
  return std::make_unique<CpuTrainDevice>(setup);
}

std::unique_ptr<TrainDevice> MakeTrainDevice(Device device, const TrainDeviceSetup& setup) {
  if (device.is_cpu()) return MakeCpuTrainDevice(setup);
  return CudaFunction<decltype(cuda::MakeCudaTrainDevice)>("MakeCudaTrainDevice")(device, setup);
}

}  // namespace oraclegs
