#include "oraclegs/train/cpu_train_device.h"
#include "oraclegs/render/make_rasterizer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "oraclegs/train/make_densifier.h"
#include "oraclegs/train/method_part.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/regularizers.h"
#include "oraclegs/train/scale_cap.h"
#include "oraclegs/train/view_loss.h"

namespace oraclegs {
namespace {

/// Steps a block of Gaussians while its gradients are in the cache.
struct StepConsumer final : GradientConsumer {
  const Iteration& iteration;
  Gaussians* gaussians;
  Regularizers* regularizers;
  const Gaussians* beside = nullptr;  // gradients of parts of other methods; null = there are none
  std::optional<AdamStep> step;       // nothing: Gaussians stay, only the regularizers' value is wanted
  bool adds_noise = false;

  StepConsumer(const Iteration& iteration_in, Gaussians* gaussians_in, Regularizers* regularizers_in)
      : iteration(iteration_in), gaussians(gaussians_in), regularizers(regularizers_in) {}

  void ConsumeBlock(int64_t begin, int64_t end, const GaussianRows& grads) override {
    regularizers->AddTo(begin, end, grads);
    if (beside != nullptr) AddRows(*beside, begin, end, 3 * ShCount(iteration.sh_degree), grads);
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
    densifier_->Begin(setup.start);
  }

  Rasterizer& rasterizer() override { return *rasterizer_; }
  RenderTimings TimingsSoFar() const override { return rasterizer_->timings(); }

  TrainedModel Upload(const TrainedModel& host) override {
    if (host.adam.size() > 0) return {host.gaussians.Clone(), host.adam.Clone()};
    return {host.gaussians.Clone(), Adam(host.gaussians.size(), options_.sh_moments)};
  }
  TrainedModel Download(const TrainedModel& model) const override {
    return {model.gaussians.Clone(), model.adam.Clone()};
  }

  void RunParts(const Iteration& iteration, TrainedModel* model) override {
    loss_of_parts_ = 0;
    const int64_t before = model->gaussians.size();
    for (const std::shared_ptr<MethodPart>& part : parts_) part->Remove(iteration, model);
    const int64_t n = model->gaussians.size();
    if (n != before) densifier_->Begin(n);
    if (adds_gradients_ && beside_.size() != n) {
      beside_ = Gaussians::Zeros(n);
    } else if (adds_gradients_) {
      beside_.ForEach([](const char*, Buffer<float>& t) { t.SetZero(); });
    }
    for (const std::shared_ptr<MethodPart>& part : parts_) {
      loss_of_parts_ += part->BeforeView(iteration, model, &beside_);
    }
  }

  Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) override {
    if (!opacity_factors_.defined() || opacity_factors_.count() != n) {
      opacity_factors_ = Buffer<float>::Empty({n});
    }
    DrawOpacityFactors(perturbation, opacity_factors_);
    return opacity_factors_;
  }

  RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) override {
    const ViewLossResult result = view_loss_(iteration.view, iteration.number, out, iteration.seed);
    loss_of_view_ = result.loss;
    AddTerms(iteration.view.kind, result);
    return result.grads;
  }

  void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) override {
    Gaussians* gaussians = &model->gaussians;
    regularizers_.Begin(*gaussians, {options_.opacity_reg, options_.scale_reg});
    StepConsumer consumer(iteration, gaussians, &regularizers_);
    const bool adds_noise = densifier_->AddsNoise();
    // In an iteration that refines the noise comes after relocation and growth.
    consumer.adds_noise = adds_noise && !iteration.refines;
    if (adds_gradients_) consumer.beside = &beside_;
    // Programs with adaptive density control take no step in an iteration that refines: the new parameters have no
    // gradient yet.
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

  void Refine(const Iteration& iteration, TrainedModel* model) override { densifier_->Refine(iteration, model); }
  ScreenGradients densify_state() const override { return densifier_->state(); }
  void RestoreDensify(const ScreenGradients& state, int64_t gaussians) override {
    densifier_->Restore(state, gaussians);
  }

  void BeginDensify(int64_t gaussians) override { densifier_->Begin(gaussians); }

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
  std::unique_ptr<Densifier> densifier_ = MakeDensifier({options_, plan_, rasterizer_.get()});
  std::vector<float> camera_centers_ = CameraCenters(plan_.photos());
  Regularizers regularizers_;
  Buffer<float> opacity_factors_;  // [N]
  Gaussians beside_;               // gradients of the parts, for one iteration
  bool adds_gradients_ =
      std::any_of(parts_.begin(), parts_.end(), [](const auto& part) { return part->AddsGradients(); });
  double loss_of_view_ = 0, loss_of_parts_ = 0;
  LossReport loss_;
  TermSums terms_;
};

}  // namespace

std::unique_ptr<TrainDevice> MakeCpuTrainDevice(const TrainDeviceSetup& setup) {
  return std::make_unique<CpuTrainDevice>(setup);
}

}  // namespace oraclegs
