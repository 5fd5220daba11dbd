#include "oraclegs/train/cuda/cuda_train_device.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "oraclegs/render/cuda/cuda_rasterizer.h"
#include "oraclegs/train/cuda/cuda_view_loss.h"
#include "oraclegs/train/cuda/opacity_factors.h"
#include "oraclegs/train/cuda/refine.h"
#include "oraclegs/train/cuda/scale_cap.h"
#include "oraclegs/train/cuda/step.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/memory_estimate.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/regularizers.h"
#include "oraclegs/train/scale_cap.h"

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

class CudaTrainDevice final : public TrainDevice {
 public:
  CudaTrainDevice(Device device, const TrainDeviceSetup& setup)
      : device_(device),
        options_(setup.options),
        plan_(setup.plan),
        rasterizer_(MakeCudaRasterizer(device)),
        capacity_(std::max<int64_t>(options_.max_gaussians.value(), setup.start)),
        loss_(plan_, ViewsOnDevice(), device) {
    ReserveForCapacity();
    accumulator_.ReserveExactly(1);
    accumulator_.FillBytes(0, 1, kStream);
    std::vector<double> choose;
    for (const auto& row : Binomials()) choose.insert(choose.end(), row.begin(), row.end());
    choose_.Upload(choose.data(), static_cast<int64_t>(choose.size()));
    if (options_.prune_floaters) {
      const std::vector<DepthView> views = loss_.views().DepthViews(plan_.photos());
      num_depth_views_ = static_cast<int>(views.size());
      depth_views_.Upload(views.data(), num_depth_views_);
      floater_counts_.ReserveExactly(2);
    }
    const std::vector<float> centers = CameraCenters(plan_.photos());
    num_cameras_ = static_cast<int>(centers.size() / 3);
    camera_centers_.Upload(centers.data(), static_cast<int64_t>(centers.size()));
    unchecked_.reserve(kMaxUnchecked);
  }

  Rasterizer& rasterizer() override { return *rasterizer_; }
  RenderTimings TimingsSoFar() const override { return {}; }

  /// Uploads with room for max_gaussians, so that no growth copies them.
  TrainedModel Upload(const TrainedModel& host) override {
    if (host.gaussians.size() > capacity_) {  // a checkpoint of more
      capacity_ = host.gaussians.size();
      ReserveForCapacity();
    }
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
    return loss_(iteration.view, iteration.number, out, &sums_);
  }

  void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) override {
    const int64_t n = model->gaussians.size();
    const RegularizerSums weights = RegularizerOptions{options_.opacity_reg, options_.scale_reg}.PerEntry(n);
    RunRegularizerSums({n, model->gaussians.Rows(), regularizer_sums_.data()}, kStream);  // of what has not moved yet
    if (iteration.moves) {
      DeviceStep device_step;
      StepConstants& step = device_step.step;
      step.params = model->gaussians.Rows();
      step.adam = model->adam.BeginStep(iteration.rates, iteration.sh_degree, std::as_const(model->gaussians));
      step.moments = model->adam.Rows();
      step.regularizers = {static_cast<float>(weights.opacity), static_cast<float>(weights.scale)};
      step.noise = NoiseOf(iteration);
      step.adds_noise = !iteration.refines;  // else it comes after relocation and growth
      rasterizer_->BackwardInto(model->gaussians, upstream, &device_step);
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
    const int64_t n = model->gaussians.size();
    if (options_.prune_floaters) {
      RunPruneFloaters(
          {model->gaussians.Rows(), n, depth_views_.data(), num_depth_views_, floats_.data(), floater_counts_.data()},
          kStream);
    }
    const RefineInput in = Refinement(iteration, *model);
    RunRelocate(in, kStream);
    if (const int64_t added = GrowthOf(n, options_.max_gaussians.value()); added > 0) {
      RunWeigh(in, kStream);
      total_weight_.Ask(in.scratch.weights + n - 1, kStream);
      if (total_weight_.Get() > 0) {
        const auto grow = [&](auto& buffer) { buffer = buffer.GrownTo(n + added); };
        model->gaussians.ForEach([&](const char*, Buffer<float>& buffer) { grow(buffer); });
        model->adam.ForEachMoment([&](const char*, const char*, auto& buffer) { grow(buffer); });
        RunGrow(in, added, kStream);
      }
    }
    RunNoise({model->gaussians.size(), model->gaussians.Rows(), NoiseOf(iteration)}, kStream);
  }

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

  ExposureState exposures() const override { return loss_.exposures(); }
  void RestoreExposures(const ExposureState& state) override { loss_.RestoreExposures(state); }

 private:
  /// The views on the device. First checks that all buffers fit.
  DeviceViews ViewsOnDevice() {
    DeviceViews views(plan_);
    TrainingSize size{capacity_, LargestOf(plan_).pixels, views.bytes(), 0, options_.sh_moments};
    size.rasterizer_bytes = EstimateRasterizerBytes(capacity_, kPairsAGaussian * capacity_, size.pixels);
    RequireMemory(EstimateMemory(size), MemoryOfDevice().free);
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

  /// Allocates every per-Gaussian buffer except the model.
  void ReserveForCapacity() {
    regularizer_sums_.ReserveExactly(StepBlocks(capacity_));
    opacity_factors_ = Buffer<float>();
    if (options_.prune_floaters) floats_.ReserveExactly(capacity_);
    rasterizer_->ReserveGaussians(capacity_);
    weights_.ReserveExactly(capacity_);
    ranks_.ReserveExactly(capacity_);
    totals_.ReserveExactly(RefineBlocks(capacity_));
    sources_.ReserveExactly(capacity_);
    draws_.ReserveExactly(capacity_);
  }

  RefineInput Refinement(const Iteration& iteration, const TrainedModel& model) {
    RefineInput in;
    in.seed = iteration.seed;
    in.iteration = iteration.number;
    in.count = model.gaussians.size();
    in.params = model.gaussians.Rows();
    in.moments = model.adam.Rows();
    in.scratch = {weights_.data(), ranks_.data(), totals_.data(), sources_.data(), draws_.data(), choose_.data()};
    return in;
  }

  Device device_;
  TrainOptions options_;
  const LossPlan& plan_;
  std::unique_ptr<Rasterizer> rasterizer_;
  int64_t capacity_;  // Gaussians
  CudaViewLoss loss_;
  LossSums sums_;                     // of the iteration
  std::vector<Iteration> unchecked_;  // whose loss the host has not seen
  DeviceArray<RegularizerSums> regularizer_sums_{"the sums of the loss"};
  DeviceArray<LossAccumulator> accumulator_{"the sums of the loss"};
  Readback<LossAccumulator> read_accumulator_;
  Readback<uint64_t> total_weight_;
  Buffer<float> opacity_factors_;  // [capacity]
  DeviceArray<uint64_t> weights_{"relocation"}, ranks_{"relocation"}, totals_{"relocation"};
  DeviceArray<int> sources_{"relocation"}, draws_{"relocation"};
  DeviceArray<double> choose_{"relocation"};
  DeviceArray<float> camera_centers_{"the cameras' positions"};
  int num_cameras_ = 0;
  DeviceArray<DepthView> depth_views_{"the pruning of floaters"};
  int num_depth_views_ = 0;
  DeviceArray<uint8_t> floats_{"the pruning of floaters"};
  DeviceArray<int> floater_counts_{"the pruning of floaters"};
};

}  // namespace

std::unique_ptr<TrainDevice> MakeCudaTrainDevice(Device device, const TrainDeviceSetup& setup) {
  UseDevice(std::max(0, device.index));
  return std::make_unique<CudaTrainDevice>(device, setup);
}

}  // namespace oraclegs::cuda
