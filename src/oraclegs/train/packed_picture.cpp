#include "oraclegs/train/packed_picture.h"

#include <array>
#include <atomic>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kGrain = 1 << 16;  // values a task

}  // namespace

Buffer<float> Packed(const Buffer<float>& picture) {
  if (!picture.defined()) return picture;
  const Buffer<float> flat = picture.reshape({-1});
  RequireShape("Packed", "picture", flat, {-1});
  const Buffer<float> bytes = torch::empty({flat.count()}, torch::kByte);
  const float* from = flat.data();
  uint8_t* to = bytes.data();
  std::atomic<bool> exact = true;
  ParallelBlocks(flat.count(), kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end && exact; ++i) {
      const bool in_range = from[i] >= 0 && from[i] <= 1;
      to[i] = in_range ? static_cast<uint8_t>(from[i] * 255 + 0.5f) : 0;
      if (!in_range || static_cast<float>(to[i]) / 255 != from[i]) exact = false;
    }
  });
  return exact ? bytes.view(picture.shape()) : picture;
}

}  // namespace oraclegs
