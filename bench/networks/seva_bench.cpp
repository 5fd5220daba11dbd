// One guided denoising step of SEVA at full width with made-up weights, held against the matrix products that the
// machine does in the same run: the floor is the step's operations at that rate. Prints one line.
//   build/release/bin/seva_bench [FRAMES [SIDE [float32|bfloat16|float16|autocast [batched|in-turn [cpu|cuda]]]]]
// 21 576 bfloat16 batched cuda is the published size; 2 128 is one that a processor does in a minute.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "bench/networks/placed_parameters.h"
#include "bench/networks/seva_cost.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/host.h"
#include "oraclegs/networks/seva/conditioning.h"
#include "oraclegs/networks/seva/memory.h"
#include "oraclegs/networks/seva/model.h"

namespace oraclegs::seva {
namespace {

struct Settings {
  int64_t frames = 2, side = 128;
  Halves halves = Halves::kBatched;
  torch::Device device = torch::kCPU;
  Precision precision = Precision::kFloat32;

  Placement placement() const { return PlaceOn(device, precision); }
};

Settings Parse(const std::vector<std::string>& words) {
  Settings settings;
  if (words.size() > 0) settings.frames = std::stoll(words[0]);
  if (words.size() > 1) settings.side = std::stoll(words[1]);
  if (words.size() > 2) {
    const std::optional<Precision> precision = FromWord<Precision>(words[2]);
    if (!precision) throw UsageError("{} is no precision; there are {}", words[2], AllWords<Precision>(", "));
    settings.precision = *precision;
  }
  if (words.size() > 3 && words[3] == "in-turn") settings.halves = Halves::kInTurn;
  if (words.size() > 4) settings.device = torch::Device(words[4]);
  return settings;
}

/// Seconds of the fastest of three calls.
template <class F>
double Seconds(const Settings& settings, F&& f) {
  double fastest = 1e30;
  for (int i = 0; i < 3; ++i) {
    WaitFor(settings.device);
    const auto start = std::chrono::steady_clock::now();
    f();
    WaitFor(settings.device);
    fastest = std::min(fastest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return fastest;
}

/// Operations a second of a large matrix product.
double MatrixPeak(const Settings& settings) {
  const int64_t n = settings.device.is_cuda() ? 8192 : 2048;
  const Placement placement = settings.placement();
  const torch::ScalarType type = placement.products.value_or(placement.type);
  const Tensor a = at::rand({n, n}).to(settings.device, type), b = a.clone();
  const double size = static_cast<double>(n);
  return 2 * size * size * size / Seconds(settings, [&] { at::mm(a, b); });
}

void Measure(const Settings& settings) {
  const Placement placement = settings.placement();
  PlacedParameters source(placement.device, placement.type);
  Unet unet = LoadUnet(source, UnetConfig());
  unet.products = placement.products;
  const int64_t latent = settings.side / 8;
  Frames frames;
  frames.height = frames.width = latent;
  for (int64_t t = 0; t < settings.frames; ++t) {
    View view;
    view.world_from_camera.translation().x() = 0.1 * static_cast<double>(t);
    view.intrinsics << 1, 0, 0.5, 0, 1, 0.5, 0, 0, 1;
    frames.views.push_back(view);
    frames.given.push_back(t == 0);
    frames.latents.push_back(at::zeros({1, 4, latent, latent}));
    frames.embeddings.push_back(at::zeros({1, unet.config.context_width}));
  }
  const Network network = MakeNetwork(unet, MakeInputs(frames, settings.device), settings.halves);
  const Tensor x = Noise({}, {2 * settings.frames, 4, latent, latent}).to(settings.device);
  const double peak = MatrixPeak(settings), seconds = Seconds(settings, [&] { network(x, 500); });
  const double operations = CostOfStep(unet, settings.frames, latent, latent).total;
  MemoryRequest memory{settings.frames, {settings.side, settings.side}, settings.halves, placement.type};
  memory.gpu = settings.device.is_cuda();
  std::printf("%s\n",
              fmt::format("{} frames of {} x {}, {}, {}: {:.3f} s a step of {:.3f} TFLOP, at least {:.3f} s at the "
                          "{:.3f} TFLOP/s of matrix products: {:.0f} % of them; planned {:.1f} GB, process at most "
                          "{:.1f} GB",
                          settings.frames, settings.side, settings.side, Word(settings.precision),
                          settings.halves == Halves::kBatched ? "batched" : "in turn", seconds, operations / 1e12,
                          operations / peak, peak / 1e12, 100 * operations / seconds / peak,
                          static_cast<double>(EstimateMemory(unet.config, memory).total()) / 1e9,
                          static_cast<double>(PeakMemoryBytes()) / 1e9)
                  .c_str());
}

}  // namespace
}  // namespace oraclegs::seva

int main(int argc, char** argv) {
  try {
    oraclegs::seva::Measure(oraclegs::seva::Parse({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "seva_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
