#pragma once
// Estimate of the GPU memory that a training needs, before it begins.

#include <cstdint>
#include <string>
#include <vector>

#include "oraclegs/train/step_constants.h"

namespace oraclegs {

/// Bytes of one Gaussian's parameters and both moments of Adam.
constexpr int64_t ModelBytes(ShMoments sh_moments) {
  constexpr int64_t kSmall = 11, kSh = kShFloats;  // numbers of a Gaussian: without and of its spherical harmonics
  constexpr int64_t kOfSh[] = {2 * 4 * kSh, 2 * 2 * kSh, 2 * kSh + 4};  // in the order of ShMoments
  return 4 * (kSmall + kSh) + 2 * 4 * kSmall + kOfSh[static_cast<int>(sh_moments)];
}
/// Bytes per Gaussian that relocation, opacity factors and the regularizers' sums need.
inline constexpr int64_t kTrainScratchBytes = 8 + 8 + 4 + 4 + 4 + 1;

struct TrainingSize {
  int64_t gaussians = 0;         ///< maximum of the run
  int64_t pixels = 0;            ///< pixels of the largest view
  int64_t view_bytes = 0;        ///< packed planes of all views on the device
  int64_t rasterizer_bytes = 0;  ///< rasterizer's need for that many Gaussians and pixels
  ShMoments sh_moments = ShMoments::kFull;
};

struct MemoryItem {
  std::string what;  ///< plural noun in the user's terms: "photos and proposals"
  int64_t bytes = 0;
};

/// The items by falling size.
std::vector<MemoryItem> EstimateMemory(const TrainingSize& size);

int64_t TotalBytes(const std::vector<MemoryItem>& items);

/// Throws OutOfMemory unless the items fit into `free` bytes; the message says what is needed for what, what is free
/// and which options lower it.
void RequireMemory(const std::vector<MemoryItem>& items, int64_t free);

}  // namespace oraclegs
