// Time and memory of Depth Anything V2 for one image: full size, made-up weights, this machine.
//
//   build/release/bin/depth_anything_bench [small|base|large] [WIDTH HEIGHT]

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "oraclegs/core/host.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/networks/depth_anything/depth_anything.h"

int main(int argc, char** argv) {
  using namespace oraclegs;
  const std::string word = argc > 1 ? argv[1] : "large";
  const DepthAnythingSize size = word == "small"  ? DepthAnythingSize::kSmall
                                 : word == "base" ? DepthAnythingSize::kBase
                                                  : DepthAnythingSize::kLarge;
  const int64_t width = argc > 3 ? std::atoll(argv[2]) : 690, height = argc > 3 ? std::atoll(argv[3]) : 518;
  RandomParameters source(1);
  const DepthAnything model = LoadDepthAnything(source, DepthAnythingV2(size));
  const double weights = static_cast<double>(PeakMemoryBytes()) / (1 << 20);
  torch::manual_seed(1);
  const Tensor image = torch::rand({height, width, 3});
  const auto start = std::chrono::steady_clock::now();
  const Tensor map = RelativeInverseDepth(model, image);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double peak = static_cast<double>(PeakMemoryBytes()) / (1 << 20);
  std::printf("%s\n",
              fmt::format("Depth Anything V2 {}, {} x {}: {:.1f} s, peak {:.0f} MiB, weights and program {:.0f} MiB, "
                          "{} threads",
                          word, width, height, seconds, peak, weights, NumThreads())
                  .c_str());
  return map.numel() == width * height ? 0 : 1;
}
