#pragma once
// The families of stage_bench, and their common parts.

#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>
#include <string>

#include "bench/inputs.h"

namespace oraclegs {

struct Case {
  std::string name;  ///< FAMILY/INPUT/GAUSSIANS/WIDTHxHEIGHT
  InputSource source;
  InputSize size;
};

/// Measures whole iterations: median ms and share of the ceiling by stage, pairs per second.
void MeasureStages(benchmark::State& state, const Case& c);
/// Measures each part of a fused iteration by itself on the same input.
void MeasureAlone(benchmark::State& state, const Case& c);
/// Measures blending on 1 thread and on all; fails when images or gradients differ in a bit.
void MeasureThreads(benchmark::State& state, const Case& c);
/// Measures the peak memory of the process, which should run nothing else.
void MeasureMemory(benchmark::State& state, const Case& c);

/// Sets counters that describe the case; `view` is one of the input's.
void DescribeCase(const Case& c, const TrainView& view, benchmark::State* state);

template <class F>
double MillisecondsOf(F&& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// State of the running benchmark. One is kept: it stays while Google Benchmark calls the same benchmark again with
/// more iterations, and another benchmark's replaces it.
class Workpiece {
 public:
  template <class T, class Make>
  static T& Get(const std::string& name, Make&& make) {
    Workpiece& kept = Kept();
    if (kept.name_ != name) {
      kept.value_.reset();
      kept.value_ = std::make_shared<T>(make());
      kept.name_ = name;
    }
    return *static_cast<T*>(kept.value_.get());
  }

 private:
  static Workpiece& Kept() {
    static Workpiece kept;
    return kept;
  }

  std::string name_;
  std::shared_ptr<void> value_;
};

}  // namespace oraclegs
