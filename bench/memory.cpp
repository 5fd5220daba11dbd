// Peak memory of a training run.

#include "bench/benchmarks.h"
#include "oraclegs/core/host.h"

namespace oraclegs {

/// Measures the last growth steps and iterations at the full count; counts everything that the process holds, images
/// and libraries included.
void MeasureMemory(benchmark::State& state, const Case& c) {
  InputSize start = c.size;
  start.gaussians -= start.gaussians / 25;  // one growth step of 5 % is enough
  BenchInput input = MakeInput(c.source, start);
  const TrainView view = input.views.front();
  const int64_t views = static_cast<int64_t>(input.views.size());
  const double input_peak = static_cast<double>(PeakMemoryBytes());
  const auto trainer = MakeGrowingTrainer(std::move(input), c.size.gaussians);
  while (trainer->gaussians().size() < c.size.gaussians) trainer->Step();
  while (state.KeepRunningBatch(views)) {
    for (int64_t i = 0; i < views; ++i) trainer->Step();
  }
  DescribeCase(c, view, &state);
  state.counters["input_peak_bytes"] = input_peak;
  state.counters["peak_bytes"] = static_cast<double>(PeakMemoryBytes());
}

}  // namespace oraclegs
