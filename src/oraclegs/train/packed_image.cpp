#include "oraclegs/train/packed_image.h"

#include <atomic>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kPackGrain = 1 << 16;  // values a task

}  // namespace

PackedImage Packed(const Buffer<float>& image) {
  if (!image.defined()) return {};
  const Buffer<uint8_t> bytes = Buffer<uint8_t>::Empty(image.shape());
  const float* from = image.data();
  uint8_t* to = bytes.data();
  std::atomic<bool> exact = true;
  ParallelBlocks(image.count(), kPackGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end && exact; ++i) {
      const bool in_range = from[i] >= 0 && from[i] <= 1;
      to[i] = in_range ? static_cast<uint8_t>(from[i] * 255 + 0.5f) : 0;
      if (!in_range || static_cast<float>(to[i]) / 255 != from[i]) exact = false;
    }
  });
  if (exact) return {{}, bytes};
  return {image, {}};
}

}  // namespace oraclegs
