#include "oraclegs/train/train_device.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "oraclegs/render/render.h"
#include "oraclegs/train/cuda/cuda_mcmc.h"
#include "oraclegs/train/cuda/cuda_view_loss.h"
#include "oraclegs/train/cuda/outliers.h"
#include "oraclegs/train/cuda/step.h"
#include "oraclegs/train/memory_estimate.h"
#include "oraclegs/train/method_part.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/outliers.h"
#include "oraclegs/train/regularizers.h"

namespace oraclegs::cuda {
namespace {

constexpr size_t kMaxUnchecked = 1024;  // iterations whose loss the host has not asked for
// Expected tiles per Gaussian. It depends on the scene; trained models have about three in the mean, invisible
// Gaussians included.
constexpr int64_t kPairsAGaussian = 3;

/// Takes the step of each gradient while it is in registers.
struct DeviceStep final : GradientConsumer {
  StepConstants step;

  void ConsumeOnDevice(const GaussianBackwardInput& in) override { RunStep(in, step); }
};

/// Takes no step, in iterations that a densifier watches alone.
struct NoDeviceStep final : GradientConsumer {
  void ConsumeOnDevice(const GaussianBackwardInput& in) override { RunWithoutStep(in); }
};

class CudaTrainDevice final : public TrainDevice {
 public:
  CudaTrainDevice(Device device, const TrainDeviceSetup& setup)
      : device_(device),
        options_(setup.options),
        plan_(setup.plan),
        parts_(setup.parts),
        rasterizer_(MakeCudaRasterizer(device)),
        capacity_(std::max<int64_t>(options_.max_gaussians, setup.start)),
        loss_(plan_, ViewsOnDevice(), device) {
    ReserveForCapacity();
    accumulator_.ReserveExactly(1);
    accumulator_.FillBytes(0, 1, kStream);
    const std::vector<float> centers = CameraCenters(plan_.photos());
    num_cameras_ = static_cast<int>(centers.size() / 3);
    camera_centers_.Upload(centers.data(), static_cast<int64_t>(centers.size()));
    unchecked_.reserve(kMaxUnchecked);
    const DensifierSetup densifier{options_, plan_, rasterizer_.get(), device_};
    densifier_ =
        setup.densifier ? setup.densifier(densifier) : MakeCudaMcmcDensifier(densifier, loss_.views(), capacity_);
    densifier_->Begin(setup.start);
    for (const std::shared_ptr<MethodPart>& part : parts_) part->Attach(*this);
  }

  Rasterizer& rasterizer() override { return *rasterizer_; }
  RenderTimings TimingsSoFar() const override { return {}; }
  std::unique_ptr<Rasterizer> NewRasterizer() const override { return MakeCudaRasterizer(device_); }

  /// Uploads with room for max_gaussians, so that no growth copies them.
  TrainedModel Upload(const TrainedModel& host) override {
    RequireCapacity(host.gaussians.size());  // a checkpoint may have more
    TrainedModel model{host.gaussians,
                       host.adam.size() > 0 ? host.adam : Adam(host.gaussians.size(), options_.sh_moments)};
    const auto upload = [&](const char*, auto& buffer) { buffer = OnDeviceWithRoom(buffer); };
    model.gaussians.ForEach(upload);
    model.adam.ForEachMoment([&](const char*, const char* name, auto& buffer) { upload(name, buffer); });
    return model;
  }

  TrainedModel Download(const TrainedModel& model) const override {
    TrainedModel host = model;
    host.gaussians.ForEach([](const char*, Buffer<float>& buffer) { buffer = buffer.CopyOn(kCpu); });
    host.adam.ForEachMoment([](const char*, const char*, auto& buffer) { buffer = buffer.CopyOn(kCpu); });
    return host;
  }

  void RunParts(const Iteration& iteration, TrainedModel* model) override {
    part_gradients_.clear();
    loss_of_parts_ = oraclegs::RunParts(parts_, iteration, densifier_.get(), model, &part_gradients_);
  }

  Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) override {
    if (!opacity_factors_.defined()) {
      opacity_factors_ = Buffer<float>::Empty({capacity_}, device_, "opacity factors");
    }
    const Buffer<float> factors = opacity_factors_.Rows(0, n);
    RunOpacityFactors(
        {perturbation.seed, perturbation.iteration, perturbation.drop, perturbation.noise, n, factors.data()}, kStream);
    return factors;
  }

  RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) override {
    sums_ = {};
    RenderGrads grads = loss_(iteration.view, iteration.number, out, &sums_);
    for (const std::shared_ptr<MethodPart>& part : parts_) loss_of_parts_ += part->OnView(iteration, out, &grads);
    sums_.constant += loss_of_parts_;
    return grads;
  }

  void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) override {
    const int64_t n = model->gaussians.size();
    const RegularizerSums weights = RegularizerOptions{options_.opacity_reg, options_.scale_reg}.PerEntry(n);
    RunRegularizerSums({n, model->gaussians.Rows(), regularizer_sums_.data()}, kStream);  // of what has not moved yet
    const bool adds_noise = densifier_->AddsNoise();
    if (iteration.moves && (adds_noise || !iteration.refines)) {
      DeviceStep device_step;
      StepConstants& step = device_step.step;
      step.params = model->gaussians.Rows();
      step.adam = model->adam.BeginStep(iteration.rates, iteration.sh_degree, std::as_const(model->gaussians));
      step.moments = model->adam.Rows();
      step.regularizers = {static_cast<float>(weights.opacity), static_cast<float>(weights.scale)};
      step.noise = NoiseOf(iteration);
      step.adds_noise = adds_noise && !iteration.refines;  // else it comes after relocation and growth
      if (part_gradients_.size() > kMaxPartGradients) throw std::logic_error("too many parts add gradients");
      for (const Gaussians* part : part_gradients_) step.part_gradients[step.parts++] = part->Rows();
      rasterizer_->BackwardInto(model->gaussians, upstream, &device_step);
    } else if (iteration.moves) {
      NoDeviceStep none;
      rasterizer_->BackwardInto(model->gaussians, upstream, &none);
    }
    sums_.Add({&regularizer_sums_.data()->opacity, StepBlocks(n), 2, weights.opacity});
    sums_.Add({&regularizer_sums_.data()->scale, StepBlocks(n), 2, weights.scale});
    RunAccumulateLoss({sums_, iteration.number, kLossSmoothing, accumulator_.data()}, kStream);
    unchecked_.push_back(iteration);
    if (unchecked_.size() >= kMaxUnchecked) Loss();
  }

  void CapScales(TrainedModel* model) override {
    RunCapScales({model->gaussians.Rows(), model->gaussians.size(), camera_centers_.data(), num_cameras_,
                  static_cast<float>(std::log(options_.largest_scale))},
                 kStream);
  }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    if (!densifier_->Acts(iteration)) return;
    densifier_->Refine(iteration, model);
    RequireCapacity(model->gaussians.size());
  }
  Densifier& densifier() override { return *densifier_; }

  LossReport Loss() override {
    read_accumulator_.Ask(accumulator_.data(), kStream);
    const LossAccumulator loss = read_accumulator_.Get();
    for (const Iteration& iteration : unchecked_) {
      if (iteration.number == loss.nonfinite_iteration) {
        RequireFinite(loss.nonfinite_loss, iteration.number, plan_.View(iteration.view));
      }
    }
    unchecked_.clear();
    return {loss.last, loss.smoothed};
  }

  void RestoreLoss(double smoothed) override {
    LossAccumulator loss;
    loss.smoothed = smoothed;
    accumulator_.Upload(&loss, 1);
    unchecked_.clear();
  }

  int64_t expected_bytes() const override { return expected_bytes_; }

  ExposureState exposures() const override { return loss_.exposures(); }
  void RestoreExposures(const ExposureState& state) override { loss_.RestoreExposures(state); }

 private:
  /// The views on the device. First checks that all buffers fit.
  DeviceViews ViewsOnDevice() {
    DeviceViews views(plan_);
    TrainingSize size{capacity_, LargestOf(plan_).pixels, views.bytes(), 0, options_.sh_moments};
    size.rasterizer_bytes = EstimateRasterizerBytes(capacity_, kPairsAGaussian * capacity_, size.pixels);
    const std::vector<MemoryItem> items = EstimateMemory(size);
    RequireMemory(items, MemoryOfDevice().free);
    expected_bytes_ = TotalBytes(items);
    views.MoveTo(device_);
    return views;
  }

  template <class T>
  Buffer<T> OnDeviceWithRoom(const Buffer<T>& host) const {
    const int64_t n = host.size(0);
    const Shape shape = host.shape().WithRows(std::max(capacity_, n));
    const Buffer<T> room = Buffer<T>::Empty(shape, device_, "Gaussians and their moments").Rows(0, n);
    room.CopyFrom(host);
    return room;
  }

  static NoiseConstants NoiseOf(const Iteration& iteration) {
    return MeansNoise{iteration.seed, iteration.number, iteration.rates.means}.Constants();
  }

  /// Makes room for the work on that many Gaussians.
  void RequireCapacity(int64_t gaussians) {
    if (gaussians <= capacity_) return;
    capacity_ = gaussians;
    ReserveForCapacity();
  }

  /// Allocates every per-Gaussian buffer except those of the model and of the densifier.
  void ReserveForCapacity() {
    regularizer_sums_.ReserveExactly(StepBlocks(capacity_));
    opacity_factors_ = Buffer<float>();
    rasterizer_->ReserveGaussians(capacity_);
  }

  Device device_;
  TrainOptions options_;
  const LossPlan& plan_;
  MethodParts parts_;
  std::unique_ptr<Rasterizer> rasterizer_;
  std::unique_ptr<Densifier> densifier_;  // watches the rasterizer
  int64_t capacity_;                      // Gaussians
  int64_t expected_bytes_ = 0;            // set while loss_ is made
  CudaViewLoss loss_;
  LossSums sums_;                     // of the iteration
  PartGradients part_gradients_;      // of the iteration
  double loss_of_parts_ = 0;          // of the iteration
  std::vector<Iteration> unchecked_;  // whose loss the host has not seen
  DeviceArray<RegularizerSums> regularizer_sums_{"the sums of the loss"};
  DeviceArray<LossAccumulator> accumulator_{"the sums of the loss"};
  Readback<LossAccumulator> read_accumulator_;
  Buffer<float> opacity_factors_;  // [capacity]
  DeviceArray<float> camera_centers_{"the cameras' positions"};
  int num_cameras_ = 0;
};

}  // namespace

std::unique_ptr<TrainDevice> MakeCudaTrainDevice(Device device, const TrainDeviceSetup& setup) {
  UseDevice(std::max(0, device.index));
  return std::make_unique<CudaTrainDevice>(device, setup);
}

}  // namespace oraclegs::cuda
