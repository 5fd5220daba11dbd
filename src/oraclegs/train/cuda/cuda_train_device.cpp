#include "oraclegs/train/cuda/cuda_train_device.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "oraclegs/render/cuda/cuda_rasterizer.h"
#include "oraclegs/render/cuda/torch_memory.h"
#include "oraclegs/train/cuda/cuda_view_loss.h"
#include "oraclegs/train/cuda/fused_step.h"
#include "oraclegs/train/cuda/opacity_factors.h"
#include "oraclegs/train/cuda/refine.h"
#include "oraclegs/train/cuda/scale_cap.h"
#include "oraclegs/train/cuda/step.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/memory_estimate.h"
#include "oraclegs/train/rows.h"
#include "oraclegs/train/scale_cap.h"

namespace oraclegs::cuda {
namespace {

constexpr cudaStream_t kStream = nullptr;  // libtorch's too
constexpr size_t kMostUnchecked = 1024;    // iterations whose loss the host has not asked for
// Of the rasteriser (render/cuda/raster_core.h), with the spare quarter of its arrays by pair. How many tiles a
// Gaussian reaches depends on the scene; trained ones reach about three in the mean, those out of sight counted in.
constexpr int64_t kRasterizerBytesAGaussian = 80;
constexpr int64_t kRasterizerBytesAPair = 260;
constexpr int64_t kPairsAGaussian = 3;
constexpr int64_t kRasterizerBytesAPixel = 64;

class CudaTrainDevice final : public TrainDevice {
 public:
  CudaTrainDevice(Device device, const TrainDeviceSetup& setup, std::unique_ptr<Rasterizer> rasterizer)
      : device_(device),
        options_(setup.options),
        view_loss_(*setup.view_loss),
        rasterizer_(std::move(rasterizer)),
        fusing_(dynamic_cast<CudaRasterizer*>(rasterizer_.get())),
        capacity_(std::max<int64_t>(options_.max_gaussians, setup.start)),
        loss_(view_loss_, ViewsOnDevice(), device) {
    ReserveForCapacity();
    ledger_.ReserveExactly(1);
    ledger_.FillBytes(0, 1, kStream);
    std::vector<double> choose;
    for (const auto& row : Binomials()) choose.insert(choose.end(), row.begin(), row.end());
    choose_.Upload(choose.data(), static_cast<int64_t>(choose.size()));
    if (options_.prune_floaters) {
      const std::vector<DepthView> views = loss_.views().DepthViews(view_loss_.photographs());
      num_depth_views_ = static_cast<int>(views.size());
      depth_views_.Upload(views.data(), num_depth_views_);
      floater_counts_.ReserveExactly(2);
    }
    const std::vector<float> centers = CameraCenters(view_loss_.photographs());
    num_cameras_ = static_cast<int>(centers.size() / 3);
    camera_centers_.Upload(centers.data(), static_cast<int64_t>(centers.size()));
    unchecked_.reserve(kMostUnchecked);
  }

  Rasterizer& rasterizer() override { return *rasterizer_; }
  RenderTimings TimingsSoFar() const override { return {}; }

  /// With room for all Gaussians that there may ever be: no growth copies them.
  TrainedModel Upload(const TrainedModel& host) override {
    if (host.gaussians.size() > capacity_) {  // a checkpoint of more
      capacity_ = host.gaussians.size();
      ReserveForCapacity();
    }
    return WithMemory("Gaussians and their moments", [&] {
      const bool has_moments = host.adam.m.size() > 0;
      TrainedModel model;
      model.gaussians = UploadRows(host.gaussians);
      const Gaussians none = has_moments ? Gaussians() : Gaussians::Zeros(host.gaussians.size());
      model.adam.m = UploadRows(has_moments ? host.adam.m : none);
      model.adam.v = UploadRows(has_moments ? host.adam.v : none);
      model.adam.step = host.adam.step;
      return model;
    });
  }

  TrainedModel Download(const TrainedModel& model) const override {
    TrainedModel host;
    host.gaussians = DownloadRows(model.gaussians);
    host.adam.m = DownloadRows(model.adam.m);
    host.adam.v = DownloadRows(model.adam.v);
    host.adam.step = model.adam.step;
    return host;
  }

  Buffer<float> OpacityFactors(const OpacityPerturbation& perturbation, int64_t n) override {
    if (!opacity_factors_.defined()) {
      opacity_factors_ = WithMemory("opacity factors", [&] {
        return torch::empty({capacity_}, torch::TensorOptions().dtype(torch::kFloat).device(device_));
      });
    }
    const Buffer<float> factors = opacity_factors_.narrow(0, 0, n);
    RunOpacityFactors({perturbation.seed, perturbation.iteration, perturbation.drop, perturbation.noise, n,
                       factors.data()},
                      kStream);
    return factors;
  }

  RenderGrads LossOfView(const Iteration& iteration, const RenderOutput& out) override {
    terms_ = {};
    return loss_(iteration, out, &terms_);
  }

  void BackwardAndStep(const Iteration& iteration, const RenderGrads& upstream, TrainedModel* model) override {
    const int64_t n = model->gaussians.size();
    const double opacity_weight = options_.opacity_reg / static_cast<double>(n);
    const double scale_weight = options_.scale_reg / (3 * static_cast<double>(n));
    RunRegularizerSums({n, model->gaussians.Rows(), step_sums_.data()}, kStream);  // of what has not moved yet
    if (iteration.moves) {
      StepConstants step;
      step.params = model->gaussians.Rows();
      step.adam = model->adam.BeginStep(iteration.rates, iteration.sh_degree, std::as_const(model->gaussians));
      step.m = model->adam.m.Rows();
      step.v = model->adam.v.Rows();
      step.regularizers = {static_cast<float>(opacity_weight), static_cast<float>(scale_weight)};
      step.noise = Noise(iteration);
      step.adds_noise = !iteration.refines;  // else it comes after relocation and growth
      if (fusing_ != nullptr) {
        RunFusedStep(fusing_->BlendBackward(model->gaussians, upstream), step, kStream);
        fusing_->EndBackward();
      } else {
        rasterizer_->BackwardBlocks(model->gaussians, upstream,
                                    [&](int64_t begin, int64_t end, const GaussianRows& grads) {
                                      RunStep(From(step, begin), grads, end - begin, kStream);
                                    });
      }
    }
    terms_.Add({&step_sums_.data()->opacity, StepBlocks(n), 2, opacity_weight});
    terms_.Add({&step_sums_.data()->scale, StepBlocks(n), 2, scale_weight});
    RunLedger({terms_, iteration.number, kLossSmoothing, ledger_.data()}, kStream);
    unchecked_.push_back(iteration);
    if (unchecked_.size() >= kMostUnchecked) Loss();
  }

  void CapScales(TrainedModel* model) override {
    RunCapScales({model->gaussians.Rows(), model->gaussians.size(), camera_centers_.data(), num_cameras_,
                  static_cast<float>(std::log(options_.largest_scale))},
                 kStream);
  }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    const int64_t n = model->gaussians.size();
    const int64_t added = std::max<int64_t>(0, std::min<int64_t>(options_.max_gaussians, n + n / 20) - n);
    if (options_.prune_floaters) {
      RunPruneFloaters(
          {model->gaussians.Rows(), n, depth_views_.data(), num_depth_views_, floats_.data(), floater_counts_.data()},
          kStream);
    }
    RefineInput in = Refinement(iteration, *model);
    RunRelocate(in, kStream);
    if (added > 0) {
      RunWeigh(in, kStream);
      total_weight_.Ask(in.scratch.weights + n - 1, kStream);
      if (total_weight_.Get() > 0) {
        for (Gaussians* rows : {&model->gaussians, &model->adam.m, &model->adam.v}) GrowRows(rows, n + added);
        RunGrow(in, added, kStream);
      }
    }
    RunNoise({model->gaussians.size(), model->gaussians.Rows(), Noise(iteration)}, kStream);
  }

  LossReport Loss() override {
    read_ledger_.Ask(ledger_.data(), kStream);
    const LossAccumulator ledger = read_ledger_.Get();
    for (const Iteration& iteration : unchecked_) {
      if (iteration.number == ledger.broken) {
        RequireFinite(ledger.broken_loss, iteration.number, view_loss_.View(iteration.view, iteration.number));
      }
    }
    unchecked_.clear();
    return {ledger.last, ledger.smoothed};
  }

  void RestoreLoss(double smoothed) override {
    LossAccumulator ledger;
    ledger.smoothed = smoothed;
    ledger_.Upload(&ledger, 1);
    unchecked_.clear();
  }

  ExposureState exposures() const override { return loss_.exposures(); }
  void RestoreExposures(const ExposureState& state) override { loss_.RestoreExposures(state); }

 private:
  /// The views on the device, once it is known that all will have room.
  DeviceViews ViewsOnDevice() {
    DeviceViews views(view_loss_);
    TrainingSize size{capacity_, LargestOf(view_loss_).pixels, views.bytes(), 0};
    size.rasterizer_bytes = (kRasterizerBytesAGaussian + kPairsAGaussian * kRasterizerBytesAPair) * capacity_ +
                            kRasterizerBytesAPixel * size.pixels;
    RequireMemory(EstimateMemory(size), MemoryOfDevice().free);
    WithMemory("photographs and proposals", [&] { views.MoveTo(device_); });
    return views;
  }

  Gaussians UploadRows(const Gaussians& host) const {
    Gaussians rows = host;
    rows.ForEach([&](const char*, Buffer<float>& t) {
      std::vector<int64_t> shape = t.shape().vec();
      shape[0] = std::max(capacity_, t.size(0));
      const Buffer<float> room = torch::empty(shape, t.options().device(device_)).narrow(0, 0, t.size(0));
      room.copy_(t);
      t = room;
    });
    return rows;
  }

  static Gaussians DownloadRows(const Gaussians& rows) {
    Gaussians host = rows;
    host.ForEach([](const char*, Buffer<float>& t) { t = t.is_cpu() ? t.Clone() : t.To(kCpu); });
    return host;
  }

  static NoiseConstants Noise(const Iteration& iteration) {
    return {iteration.seed, static_cast<uint32_t>(iteration.number),
            static_cast<float>(kNoiseRate * iteration.rates.means)};
  }

  /// The step of the Gaussians from `begin` on.
  static StepConstants From(StepConstants step, int64_t begin) {
    step.first = begin;
    for (GaussianRows* rows : {&step.params, &step.m, &step.v}) *rows = rows->From(begin);
    return step;
  }

  /// All that goes by Gaussian but the model itself.
  void ReserveForCapacity() {
    step_sums_.ReserveExactly(StepBlocks(capacity_));
    opacity_factors_ = Buffer<float>();
    if (options_.prune_floaters) floats_.ReserveExactly(capacity_);
    if (fusing_ != nullptr) fusing_->ReserveGaussians(capacity_);
    weights_.ReserveExactly(capacity_);
    ranks_.ReserveExactly(capacity_);
    totals_.ReserveExactly(RefineBlocks(capacity_));
    sources_.ReserveExactly(capacity_);
    draws_.ReserveExactly(capacity_);
  }

  RefineInput Refinement(const Iteration& iteration, const TrainedModel& model) {
    const int64_t n = model.gaussians.size();
    RefineInput in;
    in.seed = iteration.seed;
    in.iteration = iteration.number;
    in.count = n;
    in.params = model.gaussians.Rows();
    in.m = model.adam.m.Rows();
    in.v = model.adam.v.Rows();
    in.scratch = {weights_.data(), ranks_.data(), totals_.data(), sources_.data(), draws_.data(), choose_.data()};
    return in;
  }

  Device device_;
  TrainOptions options_;
  const ViewLoss& view_loss_;
  std::unique_ptr<Rasterizer> rasterizer_;
  CudaRasterizer* fusing_;  // the same, when no gradient need go through memory; or null
  int64_t capacity_;        // Gaussians
  CudaViewLoss loss_;
  LossTerms terms_;                   // of the iteration
  std::vector<Iteration> unchecked_;  // whose loss the host has not seen
  DeviceArray<RegularizerBlock> step_sums_{"the sums of the loss"};
  DeviceArray<LossAccumulator> ledger_{"the sums of the loss"};
  Readback<LossAccumulator> read_ledger_;
  Readback<uint64_t> total_weight_;
  Buffer<float> opacity_factors_;  // [capacity]
  DeviceArray<uint64_t> weights_{"relocation"}, ranks_{"relocation"}, totals_{"relocation"};
  DeviceArray<int> sources_{"relocation"}, draws_{"relocation"};
  DeviceArray<double> choose_{"relocation"};
  DeviceArray<float> camera_centers_{"the photographs' places"};
  int num_cameras_ = 0;
  DeviceArray<DepthView> depth_views_{"the pruning of floaters"};
  int num_depth_views_ = 0;
  DeviceArray<uint8_t> floats_{"the pruning of floaters"};
  DeviceArray<int> floater_counts_{"the pruning of floaters"};
};

}  // namespace

std::unique_ptr<TrainDevice> MakeCudaTrainDevice(Device device, const TrainDeviceSetup& setup) {
  UseDevice(std::max(0, static_cast<int>(device.index())));
  return MakeCudaTrainDevice(device, setup, std::make_unique<CudaRasterizer>(device));
}

std::unique_ptr<TrainDevice> MakeCudaTrainDevice(Device device, const TrainDeviceSetup& setup,
                                                 std::unique_ptr<Rasterizer> rasterizer) {
  return std::make_unique<CudaTrainDevice>(device, setup, std::move(rasterizer));
}

}  // namespace oraclegs::cuda
