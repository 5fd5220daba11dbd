// The fused parts of a training iteration, each by itself.

#include <utility>

#include "bench/benchmarks.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/render/image_buffer.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/regularizers.h"

namespace oraclegs {
namespace {

struct AloneRun {
  BenchInput input;
  Gaussians grads;
  Adam adam;
  std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(kCpu);
  PhotometricLoss photometric;
  ImageBuffer grad_image;
  int64_t next = 0;

  explicit AloneRun(BenchInput made)
      : input(std::move(made)),
        grads(Gaussians::Zeros(input.gaussians.size())),
        adam(SteadyAdam(input.gaussians.size())) {}
};
struct AloneSample {
  double photometric, gaussian_backward, backward, backward_with_camera, regularizers, adam, noise;
};

AloneSample StepAlone(AloneRun* run) {
  AloneSample ms{};
  BenchInput& input = run->input;
  const TrainView& view = input.views[run->next++ % input.views.size()];
  const RenderOutput out = run->rasterizer->Forward(
      input.gaussians, view.camera, {input.background, kMaxShDegree, input.antialiased}, RenderPass::kTrain);
  Buffer<float> grad_image = run->grad_image.Get({view.camera.height, view.camera.width, 3});
  ms.photometric = MillisecondsOf([&] { run->photometric(out.image, view.image, {}, {}, &grad_image); });
  const auto backward = [&] { run->rasterizer->Backward(input.gaussians, {grad_image, {}, {}}, &run->grads); };
  backward();
  ms.gaussian_backward = run->rasterizer->timings().gaussian_backward;
  ms.backward = MillisecondsOf(backward);  // of what is in the caches now, as the next one
  run->rasterizer->WatchCamera(true);
  ms.backward_with_camera = MillisecondsOf(backward);
  run->rasterizer->WatchCamera(false);
  const TrainOptions options;
  ms.regularizers = MillisecondsOf([&] {
    AddRegularizers(input.gaussians, {options.opacity_reg, options.scale_reg}, &run->grads);
  });
  LearningRates rates;
  rates.means = 1e-6;
  ms.adam = MillisecondsOf([&] { run->adam.Step(run->grads, rates, kMaxShDegree, &input.gaussians); });
  ms.noise = MillisecondsOf([&] { AddNoise({0, run->next, rates.means}, &input.gaussians); });
  return ms;
}

}  // namespace

void MeasureAlone(benchmark::State& state, const Case& c) {
  AloneRun& run = Workpiece::Get<AloneRun>(c.name, [&] { return AloneRun(MakeInput(c.source, c.size)); });
  for (int i = 0; i < 2; ++i) StepAlone(&run);
  std::vector<AloneSample> samples;
  const int64_t views = static_cast<int64_t>(run.input.views.size());
  while (state.KeepRunningBatch(views)) {
    for (int64_t i = 0; i < views; ++i) samples.push_back(StepAlone(&run));
  }
  const auto median = [&](double AloneSample::*field) {
    std::vector<double> values;
    for (const AloneSample& s : samples) values.push_back(s.*field);
    return UpperMedian(std::move(values));
  };
  DescribeCase(c, run.input.views.front(), &state);
  state.counters["photometric_ms"] = median(&AloneSample::photometric);
  state.counters["gaussian_backward_ms"] = median(&AloneSample::gaussian_backward);
  state.counters["backward_ms"] = median(&AloneSample::backward);
  state.counters["backward_with_camera_ms"] = median(&AloneSample::backward_with_camera);
  state.counters["regularizers_ms"] = median(&AloneSample::regularizers);
  state.counters["adam_ms"] = median(&AloneSample::adam);
  state.counters["noise_ms"] = median(&AloneSample::noise);
}

}  // namespace oraclegs
