#include "bench/gpu_training.h"

#include <utility>

#include "bench/median.h"
#include "oraclegs/render/cuda/cuda_rasterizer.h"
#include "oraclegs/train/cuda/cuda_train_device.h"
#include "oraclegs/train/schedule.h"
#include "oraclegs/train/timings.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

constexpr uint64_t kSeed = 1;
constexpr double kScale = 0.008;  // world units: about four tiles a Gaussian
constexpr int kIterations = 10'000'000;
constexpr int kViews = 3;
constexpr double kOpacityNoise = 0.5;  // what the pipeline chooses
constexpr double kExtent = 1;

Gaussians On(const Gaussians& gaussians, Device device) {
  Gaussians moved = gaussians;
  moved.ForEach([&](const char*, Buffer<float>& t) { t = t.To(device); });
  return moved;
}

/// Photographs of another scene, from poses side by side.
std::vector<TrainView> Photographs(const GpuScene& scene, Device device) {
  cuda::CudaRasterizer rasterizer(device);
  const Gaussians truth = On(RandomGaussians(scene.gaussians, kScale, kSeed + 1), device);
  const Buffer<float> picture =
      rasterizer.Forward(truth, CameraOf(scene), {}, RenderPass::kInference).image.To(kCpu).Clone().clamp(0, 1);
  const Buffer<float> rounded = torch::round(picture * 255) / 255;  // as files hold them
  std::vector<TrainView> views;
  for (int i = 0; i < kViews; ++i) {
    TrainView view{"view" + std::to_string(i), CameraOf(scene), rounded, {}};
    view.camera.cam_from_world.translation().x() = 0.02 * i;
    views.push_back(std::move(view));
  }
  return views;
}

TrainOptions OptionsOf(const GpuScene& scene) {
  TrainOptions options = TrainOptions().Settled();
  options.iterations = kIterations;
  options.max_gaussians = static_cast<int>(scene.gaussians);
  options.opacity_noise = kOpacityNoise;
  return options;
}

TrainedModel SteadyModel(const GpuScene& scene) {
  TrainedModel model{GaussiansOf(scene), Adam(scene.gaussians)};
  model.adam.v.ForEach([](const char*, Buffer<float>& t) { t.fill_(1); });
  model.adam.step = 100'000;  // no bias is left to correct
  return model;
}

}  // namespace

Camera CameraOf(const GpuScene& scene) { return FrontCamera(scene.width, scene.height); }
Gaussians GaussiansOf(const GpuScene& scene) { return RandomGaussians(scene.gaussians, kScale, kSeed); }

GpuTraining::GpuTraining(const GpuScene& scene, Device device)
    : scene_(scene), options_(OptionsOf(scene)), number_(kIterations / 10 * 9) {
  view_loss_ = std::make_unique<ViewLoss>(options_, TrainingData(Photographs(scene, device)));
  train_ = cuda::MakeCudaTrainDevice(device, {options_, view_loss_.get(), scene.gaussians},
                                     std::make_unique<cuda::CudaRasterizer>(device));
  model_ = train_->Upload(SteadyModel(scene));
}

Iteration GpuTraining::Next() {
  Iteration next;
  next.seed = kSeed;
  next.number = ++number_;
  next.view = {ViewKind::kPhotograph, static_cast<int>(number_ % kViews)};
  next.rates.ScaleAll(0.1);
  next.rates.means = MeansLearningRate(number_, kIterations, kExtent);
  next.sh_degree = kMaxShDegree;
  return next;
}

Buffer<float> GpuTraining::Factors(const Iteration& iteration) {
  return train_->OpacityFactors({kSeed, iteration.number, 0, kOpacityNoise}, model_.gaussians.size());
}

RenderOutput GpuTraining::Forward(const Iteration& iteration, const Buffer<float>& factors) {
  return train_->rasterizer().Forward(model_.gaussians, view_loss_->View(iteration.view, iteration.number).camera,
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
  times->factors = Median(factors), times->forward = Median(forward), times->loss = Median(loss);
  times->project = Median(project), times->bin = Median(bin), times->blend = Median(blend);
  times->blend_backward = Median(blend_backward), times->gaussian_backward = Median(gaussian_backward);
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
  times->iteration = Median(whole), times->sending = Median(sending);
}

void GpuTraining::TimeRefine(int passes, GpuTimes* times) {
  cuda::Event begin, end;
  std::vector<double> refine;
  for (int i = 0; i < passes; ++i) {
    const Iteration next = Next();
    begin.Record(nullptr);
    train_->Refine(next, &model_);
    end.Record(nullptr);
    end.Wait();
    refine.push_back(end.MillisecondsSince(begin));
  }
  times->refine = Median(refine);
}

GpuTimes GpuTraining::Measure(int passes) {
  for (int i = 0; i < 2 * kViews; ++i) Send();  // memory gets its size
  GpuTimes times;
  TimeStages(passes, &times);
  TimeWhole(passes, &times);
  TimeRefine(1 + passes / 10, &times);  // last: it moves Gaussians
  train_->Loss();                       // throws if anything was not finite
  return times;
}

GpuWork GpuTraining::Work() const {
  const RenderStats stats = train_->rasterizer().stats();
  return {static_cast<double>(scene_.gaussians),           static_cast<double>(stats.visible),
          static_cast<double>(stats.tile_pairs),           static_cast<double>(stats.pixel_pairs),
          static_cast<double>(stats.pixel_pairs_backward), static_cast<double>(scene_.width) * scene_.height};
}

int64_t GpuTraining::scratch_bytes() const {
  return dynamic_cast<const cuda::CudaRasterizer&>(train_->rasterizer()).device_bytes();
}

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
  return Median(rates);
}

}  // namespace oraclegs
