// Blending on 1 thread and on all: speedup, and equality of the bits.

#include <cstring>
#include <utility>

#include "bench/benchmarks.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

bool SameBits(const Buffer<float>& a, const Buffer<float>& b) {
  return a.count() == b.count() && std::memcmp(a.data(), b.data(), a.count() * sizeof(float)) == 0;
}

struct Rendered {
  RenderOutput images;  // copies
  Gaussians grads;
  RenderTimings timings;
};

Rendered RenderWith(int threads, const BenchInput& input, const TrainView& view, Rasterizer* rasterizer) {
  SetNumThreads(threads);
  Rendered r;
  r.grads = Gaussians::Zeros(input.gaussians.size());
  const RenderOutput out = rasterizer->Forward(input.gaussians, view.camera,
                                               {input.background, kMaxShDegree, input.antialiased}, RenderPass::kTrain);
  r.images = {out.image.Clone(), out.alpha.Clone(), out.inv_depth.Clone()};
  rasterizer->Backward(input.gaussians, {view.image, {}, {}}, &r.grads);  // any upstream gradient serves
  r.timings = rasterizer->timings();
  SetNumThreads(0);
  return r;
}

bool SameBits(const Rendered& a, const Rendered& b) {
  bool same = SameBits(a.images.image, b.images.image) && SameBits(a.images.alpha, b.images.alpha) &&
              SameBits(a.images.inv_depth, b.images.inv_depth);
  std::vector<Buffer<float>> of_a, of_b;
  a.grads.ForEach([&](const char*, const Buffer<float>& t) { of_a.push_back(t); });
  b.grads.ForEach([&](const char*, const Buffer<float>& t) { of_b.push_back(t); });
  for (size_t i = 0; i < of_a.size(); ++i) same = same && SameBits(of_a[i], of_b[i]);
  return same;
}

}  // namespace

void MeasureThreads(benchmark::State& state, const Case& c) {
  const BenchInput input = MakeInput(c.source, c.size);
  const auto rasterizer = MakeRasterizer(kCpu);
  RenderWith(0, input, input.views.front(), rasterizer.get());  // buffers get their size
  std::vector<double> forward_1, forward_all, backward_1, backward_all, forward_ratio, backward_ratio;
  bool same = true;
  const int64_t views = static_cast<int64_t>(input.views.size());
  while (state.KeepRunningBatch(views)) {
    for (const TrainView& view : input.views) {  // one right after the other: neighbors disturb both alike
      const Rendered one = RenderWith(1, input, view, rasterizer.get());
      const Rendered all = RenderWith(0, input, view, rasterizer.get());
      same = same && SameBits(one, all);
      forward_1.push_back(one.timings.blend), forward_all.push_back(all.timings.blend);
      backward_1.push_back(one.timings.blend_backward), backward_all.push_back(all.timings.blend_backward);
      forward_ratio.push_back(one.timings.blend / all.timings.blend);
      backward_ratio.push_back(one.timings.blend_backward / all.timings.blend_backward);
    }
  }
  if (!same) state.SkipWithError("image or gradients depend on the number of threads");
  DescribeCase(c, input.views.front(), &state);
  state.counters["blend_ms_1"] = UpperMedian(std::move(forward_1));
  state.counters["blend_ms_all"] = UpperMedian(std::move(forward_all));
  state.counters["blend_speedup"] = UpperMedian(std::move(forward_ratio));
  state.counters["blend_backward_ms_1"] = UpperMedian(std::move(backward_1));
  state.counters["blend_backward_ms_all"] = UpperMedian(std::move(backward_all));
  state.counters["blend_backward_speedup"] = UpperMedian(std::move(backward_ratio));
  state.counters["same_bits"] = same ? 1 : 0;
}

}  // namespace oraclegs
