// Time of ALIKED on photos, with real weights, part by part.
//
//   build/release/bin/aliked_bench WEIGHTS.safetensors PHOTO...

#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "oraclegs/core/host.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/networks/aliked/aliked.h"
#include "oraclegs/networks/common/tensor.h"

int main(int argc, char** argv) {
  using namespace oraclegs;
  if (argc < 3) return 2;
  const aliked::Aliked network = aliked::LoadRecognizedAliked(argv[1]);
  for (int i = 2; i < argc; ++i) {
    const ImageF image = ToFloat(ReadImage(argv[i]));
    const auto pixels = Buffer<float>::From({image.height, image.width, 3}, std::span<const float>(image.data));
    auto last = std::chrono::steady_clock::now();
    const auto lap = [&] {
      const auto now = std::chrono::steady_clock::now(), before = std::exchange(last, now);
      return std::chrono::duration<double>(now - before).count();
    };
    const aliked::FeatureMaps maps = Forward(network.encoder, TensorOf(pixels));
    const double encoder = lap();
    const auto keypoints = aliked::FindKeypoints(maps.scores, {});
    const double detection = lap();
    Describe(network.head, maps, keypoints);
    const double descriptors = lap();
    std::printf("%s\n",
                fmt::format("{}: {}x{}, {} keypoints: encoder {:.2f} s, keypoints {:.2f} s, descriptors {:.2f} s, "
                            "peak {:.0f} MiB, {} threads",
                            argv[i], image.width, image.height, keypoints.size(), encoder, detection, descriptors,
                            static_cast<double>(PeakMemoryBytes()) / (1 << 20), NumThreads())
                    .c_str());
  }
  return 0;
}
