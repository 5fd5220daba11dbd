// Time of one render forward and backward, by stage, on seeded scenes. Ratios of two stages of one run are meaningful;
// milliseconds depend on the machine and on who shares it.
//
//   build/release/bin/raster_bench --benchmark_filter=/100000/

#include <benchmark/benchmark.h>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/render.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

/// Args: Gaussians, width, height, threads. Scales shrink with the count, as training makes them: the scene stays as
/// deep in overlap as a trained one, about 8 contributing Gaussians a pixel.
void BM_RenderForwardBackward(benchmark::State& state) {
  const int64_t n = state.range(0);
  const int width = static_cast<int>(state.range(1)), height = static_cast<int>(state.range(2));
  SetNumThreads(static_cast<int>(state.range(3)));
  const Gaussians g = RandomGaussians(n, (getenv("DENSE") ? 5.5 : 2.2) / std::sqrt(static_cast<double>(n)), 1);
  const Camera camera = FrontCamera(width, height);
  torch::manual_seed(1);
  const RenderGrads up{torch::randn({height, width, 3}), {}, {}};
  auto rasterizer = MakeRasterizer(torch::kCPU);
  Gaussians grads = Gaussians::Zeros(n);
  RenderTimings sum;
  for (auto _ : state) {
    benchmark::DoNotOptimize(rasterizer->Forward(g, camera, {}, RenderPass::kTrain));
    rasterizer->Backward(g, up, &grads);
    const RenderTimings t = rasterizer->timings();
    sum.project += t.project, sum.bin += t.bin, sum.blend += t.blend;
    sum.blend_backward += t.blend_backward, sum.gaussian_backward += t.gaussian_backward;
  }
  const double n_iterations = static_cast<double>(state.iterations());
  state.counters["project_ms"] = sum.project / n_iterations;
  state.counters["bin_ms"] = sum.bin / n_iterations;
  state.counters["blend_ms"] = sum.blend / n_iterations;
  state.counters["blend_bwd_ms"] = sum.blend_backward / n_iterations;
  state.counters["gauss_bwd_ms"] = sum.gaussian_backward / n_iterations;
  state.counters["pairs"] = static_cast<double>(rasterizer->stats().tile_pairs);
  const RenderStats st = rasterizer->stats();
  state.counters["fwdGF"] = 34e-6 * st.pixel_pairs / (sum.blend / n_iterations);
  state.counters["bwdGF"] = 64e-6 * st.pixel_pairs_backward / (sum.blend_backward / n_iterations);
  state.counters["Mpp"] = 1e-6 * st.pixel_pairs;
  state.counters["Mppb"] = 1e-6 * st.pixel_pairs_backward;
  state.SetItemsProcessed(state.iterations() * n);
  SetNumThreads(0);
}
BENCHMARK(BM_RenderForwardBackward)
    ->ArgsProduct({{10'000, 30'000, 100'000}, {270}, {480}, {1, 2}})
    ->Args({1'000'000, 1920, 1080, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace oraclegs

BENCHMARK_MAIN();
