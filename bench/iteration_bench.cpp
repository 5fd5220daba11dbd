// Time of one whole training iteration (forward, loss, backward, Adam, noise) on a seeded scene, by stage; gauss_bwd is
// all that is done Gaussian by Gaussian: the last part of backward, regularisers, Adam and noise. For real
// scenes read "milliseconds_per_iteration" in a workspace's stages.json.
//
//   build/release/bin/iteration_bench

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/train/trainer.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

/// Args: Gaussians, width, height. Growth is off (the count stays), all SH degrees are on from the first iteration.
void BM_Iteration(benchmark::State& state) {
  const int64_t n = state.range(0);
  const int width = static_cast<int>(state.range(1)), height = static_cast<int>(state.range(2));
  const Gaussians start = RandomGaussians(n, 2.2 / std::sqrt(static_cast<double>(n)), 1);
  const Camera front = FrontCamera(width, height);
  const Tensor picture =
      MakeRasterizer(torch::kCPU)
          ->Forward(RandomGaussians(n, 2.2 / std::sqrt(static_cast<double>(n)), 2), front, {}, RenderPass::kInference)
          .image.clone();
  std::vector<TrainView> views;
  for (int i = 0; i < 3; ++i) {
    Camera camera = front;
    camera.cam_from_world.translation().x() = 0.1 * i;
    views.push_back({"view", camera, picture, {}});
  }
  TrainOptions options;
  options.iterations = 1'000'000;
  options.max_gaussians = static_cast<int>(n);
  options.sh_degree_interval = 1;
  options.refine_start = 1'000'000;
  Trainer trainer(options, 0, {0, 0, 0}, std::move(views), start);
  for (int i = 0; i < 4; ++i) trainer.Step();  // buffers reach their size, SH its degree
  std::vector<double> milliseconds;
  for (auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(trainer.Step());
    milliseconds.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  std::nth_element(milliseconds.begin(), milliseconds.begin() + milliseconds.size() / 2, milliseconds.end());
  const TrainTimings t = trainer.MeanTimings();
  state.counters["median_ms"] = milliseconds[milliseconds.size() / 2];
  state.counters["project"] = t.render.project;
  state.counters["bin"] = t.render.bin;
  state.counters["blend"] = t.render.blend;
  state.counters["loss"] = t.loss;
  state.counters["blend_bwd"] = t.render.blend_backward;
  state.counters["gauss_bwd"] = t.render.gaussian_backward;
}
BENCHMARK(BM_Iteration)
    ->Args({10'000, 270, 480})
    ->Args({30'000, 270, 480})
    ->Args({100'000, 270, 480})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace oraclegs

BENCHMARK_MAIN();
