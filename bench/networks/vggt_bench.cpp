// Time of each part of VGGT-1B with made-up weights on this machine, and the peak memory of the process.
//
//   build/release/bin/vggt_bench [--views 4] [--width 518] [--height 350] [--device cpu|cuda]
//
// On a CPU one pass, cold: nothing is repeated, and the memory of the first pass is what counts. To be run alone. On a
// GPU the weights are bfloat16, as the program has them there, and the oracle's part alone runs, twice: the first time
// also prepares libraries.

#include <charconv>
#include <chrono>
#include <cstdio>
#include <string_view>

#include "bench/networks/placed_parameters.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {
namespace {

constexpr double kGiB = 1024.0 * 1024 * 1024;

struct Size {
  int64_t views = 4, width = 518, height = 350;
  torch::Device device = torch::kCPU;
};

/// Runs `body` and prints its name, its seconds and the peak memory of the process after it.
template <class Body>
auto Timed(const char* name, Body&& body) {
  const auto start = std::chrono::steady_clock::now();
  auto result = body();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%-22s %8.2f s  peak %6.2f GiB\n", name, seconds, static_cast<double>(PeakMemoryBytes()) / kGiB);
  std::fflush(stdout);
  return result;
}

/// Noise with structure: blocks of 16 pixels.
Tensor Images(const Size& size) {
  Rng rng(1, RandomStream::kDemoScene);
  Tensor coarse = torch::empty({size.views, 3, (size.height + 15) / 16, (size.width + 15) / 16});
  float* values = coarse.data_ptr<float>();
  for (int64_t i = 0; i < coarse.numel(); ++i) values[i] = static_cast<float>(rng.Uniform());
  return ResizeBilinear(coarse, size.height, size.width, Corners::kHalfPixel);
}

void MeasureOnGpu(const Size& size) {
  PlacedParameters source(size.device, PlaceOn(size.device).aggregator_type);
  const Vggt vggt = Timed("make up weights", [&] { return LoadVggt(source, Config(), {}); });
  const Tensor images = Images(size).to(size.device);
  for (const char* name : {"oracle, first", "oracle, again"}) {
    Timed(name, [&] {
      AggregatorResult result = Aggregate(vggt.aggregator, images, {{}, {0, 22}});
      WaitFor(size.device);
      return result;
    });
  }
}

void Measure(const Size& size) {
  const Heads heads{.camera = true, .depth = true};
  const int64_t weights = WeightBytes({}, heads);
  const int64_t estimate = PassBytes({}, {size.views, size.height, size.width, heads});
  std::printf("VGGT-1B, %d views of %d x %d, %d threads; weights %.2f GiB, pass estimated at %.2f GiB, free %.2f GiB\n",
              static_cast<int>(size.views), static_cast<int>(size.width), static_cast<int>(size.height), NumThreads(),
              static_cast<double>(weights) / kGiB, static_cast<double>(estimate) / kGiB,
              static_cast<double>(AvailableMemory()) / kGiB);
  const Tensor images = Images(size);
  const Vggt vggt = Timed("make up weights", [&] {
    RandomParameters source(7);
    return LoadVggt(source, Config(), heads);
  });
  const AggregatorResult oracle = Timed("oracle (layers 0, 22)", [&] {
    return Aggregate(vggt.aggregator, images, {{}, {0, 22}});
  });
  const AggregatorResult aggregated = Timed("aggregator for heads", [&] {
    return Aggregate(vggt.aggregator, images, {HeadLayers(vggt), {}});
  });
  Timed("camera head", [&] { return PredictCameras(vggt, aggregated); });
  const int64_t patch = vggt.config.aggregator.backbone.patch;
  Timed("depth head", [&] { return PredictDepth(vggt, aggregated, {size.height / patch, size.width / patch}); });
  std::printf("peak beside the weights %.2f GiB\n", static_cast<double>(PeakMemoryBytes() - weights) / kGiB);
}

int64_t Number(const char* option, std::string_view text) {
  int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 1) {
    throw UsageError("{} is '{}', must be a positive number", option, text);
  }
  return number;
}

int Main(int argc, char** argv) {
  Size size;
  try {
    for (int i = 1; i < argc; ++i) {
      const std::string_view option = argv[i];
      const std::string_view value = i + 1 < argc ? argv[i + 1] : "";
      if (option == "--views") {
        size.views = Number("--views", value), ++i;
      } else if (option == "--width") {
        size.width = Number("--width", value), ++i;
      } else if (option == "--height") {
        size.height = Number("--height", value), ++i;
      } else if (option == "--device" && (value == "cpu" || value == "cuda")) {
        size.device = torch::Device(std::string(value)), ++i;
      } else {
        throw UsageError("{} {} is no option; there are --views, --width, --height, --device cpu|cuda", option, value);
      }
    }
    size.device.is_cuda() ? MeasureOnGpu(size) : Measure(size);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "vggt_bench: error: %s\n", e.what());
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace oraclegs::vggt

int main(int argc, char** argv) { return oraclegs::vggt::Main(argc, argv); }
