// Cost of the parts of SEVA beside the UNet at their published size, with made-up weights: seconds and peak memory of
// one call. One part per process, so that the peak is its own.
//   build/release/bin/seva_parts_bench decode|tiled|encode|clip [WIDTH HEIGHT]

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>

#include "oraclegs/core/host.h"
#include "oraclegs/networks/seva/openclip.h"
#include "oraclegs/networks/seva/vae_tiles.h"

namespace oraclegs::seva {
namespace {

double PeakMebibytes() { return static_cast<double>(PeakMemoryBytes()) / (1 << 20); }

void Measure(const std::string& part, const std::function<Tensor()>& call) {
  const double before = PeakMebibytes();
  const auto start = std::chrono::steady_clock::now();
  const Tensor out = call();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf(
      "%s\n",
      fmt::format("{:<7} {:7.2f} s  peak {:6.0f} MiB, before the call {:6.0f} MiB  -> [{}] mean |x| {:.3f}", part,
                  seconds, PeakMebibytes(), before, fmt::join(out.sizes(), ", "), out.abs().mean().item<double>())
          .c_str());
}

int MeasurePart(const std::string& part, int64_t width, int64_t height) {
  RandomParameters source(1);
  torch::manual_seed(1);
  const Tensor image = 2 * torch::rand({1, 3, height, width}) - 1;
  if (part == "clip") {
    const OpenClip clip = LoadOpenClip(ParameterScope(source), OpenClipConfig());
    Measure(part, [&] { return ImageEmbeddings(clip, image); });
    return 0;
  }
  const Vae vae = LoadVae(source, VaeConfig());
  const int64_t scale = vae.config.downscale();
  const Tensor latents = torch::randn({1, vae.config.latent_channels, height / scale, width / scale});
  if (part == "encode") {
    Measure(part, [&] { return EncodeImages(vae, image); });
  } else if (part == "decode") {
    Measure(part, [&] { return DecodeLatents(vae, latents); });
  } else if (part == "tiled") {
    Measure(part, [&] { return DecodeTiled(vae, latents, {}); });
  } else {
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace oraclegs::seva

int main(int argc, char** argv) {
  const bool sized = argc == 4;
  try {
    const int code = argc == 2 || sized ? oraclegs::seva::MeasurePart(argv[1], sized ? std::atoll(argv[2]) : 576,
                                                                      sized ? std::atoll(argv[3]) : 576)
                                        : 2;
    if (code == 2) std::fprintf(stderr, "usage: seva_parts_bench decode|tiled|encode|clip [WIDTH HEIGHT]\n");
    return code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "seva_parts_bench: %s\n", error.what());
    return 1;
  }
}
