// Stages of a training iteration compared with the machine's limits. bench/stages.py runs it and prints tables.
//
//   build/release/bin/stage_bench [--workspace NAME=FOLDER ...] [--smoke] [Google Benchmark's options]
//
// stages/INPUT/GAUSSIANS/WIDTHxHEIGHT   whole iterations: median ms and share of the ceiling by stage
// alone/...                             what an iteration fuses, each by itself on the same input
// threads/...                           blending on 1 thread and on all, bits compared
// memory/...                            peak memory; run it as a process of its own
// INPUT is "synthetic" or the NAME of a workspace. --smoke runs each once on little data. Exit code 1: one failed.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>

#include "bench/benchmarks.h"
#include "bench/ceilings.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/run/start.h"

namespace oraclegs {

void DescribeCase(const Case& c, const TrainView& view, benchmark::State* state) {
  state->counters["gaussians"] = static_cast<double>(c.size.gaussians);
  state->counters["width"] = view.camera.width;
  state->counters["height"] = view.camera.height;
  state->counters["threads_used"] = NumThreads();
}

namespace {

using Measure = void (*)(benchmark::State&, const Case&);

bool any_failed = false;

void Register(const std::string& family, const InputSource& source, const InputSize& size, Measure measure) {
  const Case c{fmt::format("{}/{}/{}/{}x{}", family, source.name, size.gaussians, size.width, size.height), source,
               size};
  benchmark::RegisterBenchmark(c.name.c_str(),
                               [c, measure](benchmark::State& state) {
                                 try {
                                   measure(state, c);
                                 } catch (const std::exception& e) {
                                   state.SkipWithError(e.what());
                                 }
                                 any_failed |= state.error_occurred();
                               })
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}

void RegisterAll(const std::vector<InputSource>& sources) {
  constexpr InputSize kSizes[] = {{10'000, 270, 480},     {30'000, 270, 480},   {100'000, 270, 480},
                                  {1'000'000, 270, 480},  {10'000, 1080, 1920}, {100'000, 1080, 1920},
                                  {1'000'000, 1080, 1920}};
  for (const InputSource& source : sources) {
    for (const InputSize& size : kSizes) {
      Register("stages", source, size, MeasureStages);
      Register("alone", source, size, MeasureAlone);
      if (size.gaussians == 100'000) Register("threads", source, size, MeasureThreads);
    }
    Register("memory", source, {1'000'000, 1080, 1920}, MeasureMemory);
  }
}

void RegisterSmoke() {
  const InputSource source{"synthetic", {}};
  constexpr InputSize kSize{1'000, 90, 160};
  Register("stages", source, kSize, MeasureStages);
  Register("alone", source, kSize, MeasureAlone);
  Register("threads", source, kSize, MeasureThreads);
  Register("memory", source, kSize, MeasureMemory);
}

/// Whether the options include --smoke, which is removed.
bool ParseSmoke(int* argc, char** argv) {
  char** const end =
      std::remove_if(argv + 1, argv + *argc, [](const char* text) { return text == std::string("--smoke"); });
  const bool found = end != argv + *argc;
  *argc = static_cast<int>(end - argv);
  return found;
}

/// Removes the --workspace options from the command line and returns them. Throws UsageError.
std::vector<InputSource> ParseSources(int* argc, char** argv) {
  std::vector<InputSource> sources{{"synthetic", {}}};
  const std::string option = "--workspace";
  int kept = 1;
  for (int i = 1; i < *argc; ++i) {
    std::string text = argv[i];
    if (text.rfind(option, 0) != 0) {
      argv[kept++] = argv[i];
      continue;
    }
    if (text == option) {
      text = i + 1 < *argc ? argv[++i] : "";
    } else {
      text.erase(0, option.size() + 1);
    }
    const size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos) throw UsageError("--workspace is '{}', must be NAME=FOLDER", text);
    sources.push_back({text.substr(0, equals), text.substr(equals + 1)});
    ReadSavedRun(sources.back().workspace);  // a wrong folder is reported at once
  }
  *argc = kept;
  return sources;
}

int Main(int argc, char** argv) {
  try {
    if (ParseSmoke(&argc, argv)) {
      RegisterSmoke();
    } else {
      RegisterAll(ParseSources(&argc, argv));
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "stage_bench: error: %s\n", e.what());
    return 2;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("simd_target", SimdTarget());
  benchmark::AddCustomContext("threads", std::to_string(NumThreads()));
  benchmark::AddCustomContext("last_level_cache_bytes", std::to_string(LastLevelCacheBytes()));
  benchmark::AddCustomContext("copy_array_bytes", std::to_string(CopyArrayBytes()));
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return any_failed ? 1 : 0;
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) { return oraclegs::Main(argc, argv); }
