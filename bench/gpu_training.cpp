#include "bench/gpu_training.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/bfloat16.h"
#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/schedule.h"
#include "oraclegs/train/timings.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {
namespace {

constexpr uint64_t kTrainingSeed = 1;
constexpr int kIterations = 10'000'000;
constexpr double kOpacityNoise = 0.5;  // what the pipeline chooses
constexpr double kExtent = 1;

/// The image with left and right swapped and values rounded as in 8-bit files.
Buffer<float> Mirrored(const Buffer<float>& image) {
  const int64_t height = image.size(0), width = image.size(1);
  Buffer<float> mirrored = Buffer<float>::Empty(image.shape());
  for (int64_t y = 0; y < height; ++y) {
    for (int64_t x = 0; x < width; ++x) {
      for (int64_t c = 0; c < 3; ++c) {
        const float value = std::clamp(image[3 * (y * width + x) + c], 0.f, 1.f);
        mirrored[3 * (y * width + width - 1 - x) + c] = std::floor(255 * value + 0.5f) / 255;
      }
    }
  }
  return mirrored;
}

std::vector<TrainView> Targets(const GpuScene& scene, Device device) {
  const std::unique_ptr<Rasterizer> rasterizer = cuda::MakeCudaRasterizer(device);
  const RenderOutput out =
      rasterizer->Forward(scene.gaussians.To(device), scene.cameras.front(), {}, RenderPass::kInference);
  const Buffer<float> target = Mirrored(out.image.To(kCpu));
  std::vector<TrainView> views;
  for (const Camera& camera : scene.cameras) {
    if (camera.width != target.size(1) || camera.height != target.size(0)) continue;
    views.push_back({"view" + std::to_string(views.size()), camera, target, {}});
  }
  return views;
}

TrainOptions OptionsFor(const GpuScene& scene, ShMoments sh_moments) {
  TrainOptions options;
  options.iterations = kIterations;
  options.max_gaussians = static_cast<int>(scene.gaussians.size());
  options.opacity_noise = kOpacityNoise;
  options.sh_moments = sh_moments;
  return options;
}

TrainedModel SteadyModel(const GpuScene& scene, ShMoments sh_moments) {
  TrainedModel model{scene.gaussians, Adam(scene.gaussians.size(), sh_moments)};
  const auto fill = [](const char*, Buffer<float>& values) {
    if (values.defined()) std::ranges::fill(values.span(), 1.f);
  };
  model.adam.v.ForEach(fill);
  fill("sh_v", model.adam.sh_v);
  if (model.adam.sh_v_half.defined()) std::ranges::fill(model.adam.sh_v_half.span(), ToBfloat16(1.f));
  model.adam.step = 100'000;  // no bias is left to correct
  return model;
}

}  // namespace

GpuTraining::GpuTraining(const GpuScene& scene, Device device, ShMoments sh_moments)
    : options_(OptionsFor(scene, sh_moments)),
      plan_(options_, Targets(scene, device)),
      pixels_(static_cast<double>(scene.cameras.front().width) * scene.cameras.front().height),
      train_(cuda::MakeCudaTrainDevice(device, {options_, plan_, scene.gaussians.size()})),
      model_(train_->Upload(SteadyModel(scene, sh_moments))),
      number_(kIterations / 10 * 9) {}

Iteration GpuTraining::Next() {
  Iteration next;
  next.seed = kTrainingSeed;
  next.number = ++number_;
  next.view = {ViewKind::kPhoto, static_cast<int>(number_ % plan_.num_photos())};
  next.rates.ScaleAll(0.1);
  next.rates.means = MeansLearningRate(number_, kIterations, kExtent);
  next.sh_degree = kMaxShDegree;
  return next;
}

Buffer<float> GpuTraining::Factors(const Iteration& iteration) {
  return train_->OpacityFactors({kTrainingSeed, iteration.number, 0, kOpacityNoise}, model_.gaussians.size());
}

RenderOutput GpuTraining::Forward(const Iteration& iteration, const Buffer<float>& factors) {
  return train_->rasterizer().Forward(model_.gaussians, plan_.View(iteration.view).camera,
                                      {{}, iteration.sh_degree, false, factors}, RenderPass::kTrain);
}

void GpuTraining::Send() {
  const Iteration next = Next();
  const RenderOutput out = Forward(next, Factors(next));
  train_->BackwardAndStep(next, train_->LossOfView(next, out), &model_);
}

void GpuTraining::TimeStages(int passes, GpuTimes* times) {
  std::vector<double> factors, project, bin, blend, loss, blend_backward, gaussian_backward, forward;
  cuda::Event begin, drawn_from, drawn, lost, end;
  for (int i = 0; i < passes; ++i) {
    const Iteration next = Next();
    begin.Record(nullptr);
    const Buffer<float> opacities = Factors(next);
    drawn_from.Record(nullptr);
    const RenderOutput out = Forward(next, opacities);
    drawn.Record(nullptr);
    const RenderGrads upstream = train_->LossOfView(next, out);
    lost.Record(nullptr);
    train_->BackwardAndStep(next, upstream, &model_);
    end.Record(nullptr);
    end.Wait();
    const RenderTimings render = train_->rasterizer().timings();
    factors.push_back(drawn_from.MillisecondsSince(begin));
    forward.push_back(drawn.MillisecondsSince(drawn_from));
    project.push_back(render.project);
    bin.push_back(render.bin);
    blend.push_back(render.blend);
    loss.push_back(lost.MillisecondsSince(drawn));
    blend_backward.push_back(render.blend_backward);
    gaussian_backward.push_back(end.MillisecondsSince(lost) - render.blend_backward);
  }
  times->factors = UpperMedian(factors), times->forward = UpperMedian(forward), times->loss = UpperMedian(loss);
  times->project = UpperMedian(project), times->bin = UpperMedian(bin), times->blend = UpperMedian(blend);
  times->blend_backward = UpperMedian(blend_backward), times->gaussian_backward = UpperMedian(gaussian_backward);
}

void GpuTraining::TimeWhole(int passes, GpuTimes* times) {
  constexpr int kRounds = 5;
  cuda::Event begin, end;
  std::vector<double> whole, sending;
  for (int round = 0; round < kRounds; ++round) {
    begin.Record(nullptr);
    const Stopwatch watch;
    for (int i = 0; i < passes; ++i) Send();
    sending.push_back(watch.Seconds() * 1e3 / passes);
    end.Record(nullptr);
    end.Wait();
    whole.push_back(end.MillisecondsSince(begin) / passes);
  }
  times->iteration = UpperMedian(whole), times->sending = UpperMedian(sending);
}

void GpuTraining::TimeRefine(int passes, GpuTimes* times) {
  cuda::Event begin, end;
  std::vector<double> refine;
  for (int i = 0; i < passes; ++i) {
    Iteration next = Next();
    next.refines = true;
    begin.Record(nullptr);
    train_->Refine(next, &model_);
    end.Record(nullptr);
    end.Wait();
    refine.push_back(end.MillisecondsSince(begin));
  }
  times->refine = UpperMedian(refine);
}

GpuTimes GpuTraining::Measure(int passes) {
  for (int i = 0; i < 2 * plan_.num_photos(); ++i) Send();  // memory gets its size
  GpuTimes times;
  TimeStages(passes, &times);
  TimeWhole(passes, &times);
  TimeRefine(1 + passes / 10, &times);  // last: it moves Gaussians
  train_->Loss();                       // throws if anything was not finite
  return times;
}

GpuWork GpuTraining::Work() const {
  const RenderStats stats = train_->rasterizer().stats();
  return {static_cast<double>(model_.gaussians.size()),    static_cast<double>(stats.visible),
          static_cast<double>(stats.tile_pairs),           static_cast<double>(stats.pixel_pairs),
          static_cast<double>(stats.pixel_pairs_backward), pixels_};
}

int64_t GpuTraining::scratch_bytes() const { return train_->rasterizer().stats().device_bytes; }

double MeasureBandwidth(int64_t bytes) {
  cuda::DeviceArray<char> from("a copy"), to("a copy");
  from.ReserveExactly(bytes);
  to.ReserveExactly(bytes);
  from.FillBytes(1, bytes, nullptr);
  cuda::Event begin, end;
  std::vector<double> rates;
  for (int i = 0; i < 8; ++i) {
    begin.Record(nullptr);
    cuda::Check(cudaMemcpyAsync(to.data(), from.data(), static_cast<size_t>(bytes), cudaMemcpyDeviceToDevice, nullptr),
                "copying");
    end.Record(nullptr);
    end.Wait();
    const double seconds = end.MillisecondsSince(begin) * 1e-3;
    rates.push_back(seconds > 0 ? 2.0 * static_cast<double>(bytes) / seconds : 0);
  }
  return UpperMedian(rates);
}

}  // namespace oraclegs
