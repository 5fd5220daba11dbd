// Whole training iterations beside the ceilings of the moment.

#include <utility>

#include "bench/benchmarks.h"
#include "bench/ceilings.h"
#include "bench/stage_meter.h"

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

struct SteadyRun {
  TrainView view;  // the first one
  std::unique_ptr<Trainer> trainer;
  int64_t views;

  explicit SteadyRun(const BenchInput& input)
      : view(input.views.front()), trainer(MakeSteadyTrainer(input)), views(static_cast<int64_t>(input.views.size())) {
    for (int i = 0; i < 4; ++i) TimedStep(trainer.get());  // buffers get their size, SH its degree
  }
};

}  // namespace

void MeasureStages(benchmark::State& state, const Case& c) {
  SteadyRun& run = Workpiece::Get<SteadyRun>(c.name, [&] { return SteadyRun(MakeInput(c.source, c.size)); });
  const Ceilings before = MeasureCeilings();
  std::vector<IterationSample> samples;
  while (state.KeepRunningBatch(run.views)) {  // every view as often as the others
    for (int64_t i = 0; i < run.views; ++i) samples.push_back(TimedStep(run.trainer.get()));
  }
  const Ceilings ceilings = Between(before, MeasureCeilings());

  const IterationSample median = MedianOf(samples);
  const IterationShape shape{static_cast<double>(c.size.gaussians),
                             static_cast<double>(run.view.camera.width) * run.view.camera.height};
  DescribeCase(c, run.view, &state);
  state.counters["fma_gflops"] = ceilings.flops * 1e-9;
  state.counters["copy_gbps"] = ceilings.bytes * 1e-9;
  state.counters["median_ms"] = median.total;
  for (const IterationStage stage : kStages) {
    state.counters[fmt::format("{}_ms", StageName(stage))] = median.Milliseconds(stage);
    std::vector<double> shares;
    for (const IterationSample& s : samples) shares.push_back(ShareOfCeiling(stage, shape, s, ceilings));
    state.counters[fmt::format("{}_share", StageName(stage))] = UpperMedian(std::move(shares));
  }
  std::vector<double> forward, backward;
  for (const IterationSample& s : samples) {
    forward.push_back(1000 * s.pixel_pairs / s.Milliseconds(IterationStage::kBlend));
    backward.push_back(1000 * s.pixel_pairs_backward / s.Milliseconds(IterationStage::kBlendBackward));
  }
  state.counters["blend_pairs_per_second"] = UpperMedian(std::move(forward));
  state.counters["blend_backward_pairs_per_second"] = UpperMedian(std::move(backward));
  state.counters["visible"] = median.visible;
  state.counters["tile_pairs"] = median.tile_pairs;
  state.counters["pixel_pairs"] = median.pixel_pairs;
  state.counters["pixel_pairs_backward"] = median.pixel_pairs_backward;
}

}  // namespace oraclegs
