#include "oraclegs/train/memory_estimate.h"

#include <algorithm>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

// Bytes per pixel: the gradients of the render, of its inverse depth and of its alpha, the render through an exposure
// map, and the nine derivatives of SSIM (large images keep three at a time).
constexpr int64_t kLossBytesAPixel = (3 + 1 + 1 + 3 + 9) * 4;

}  // namespace

std::vector<MemoryItem> EstimateMemory(const TrainingSize& size) {
  const int64_t of_gaussian = ModelBytes(size.sh_moments) + kTrainScratchBytes;
  std::vector<MemoryItem> items = {{"Gaussians and their moments", of_gaussian * size.gaussians},
                                   {"photos and proposals", size.view_bytes},
                                   {"gradients of the image", kLossBytesAPixel * size.pixels},
                                   {"projected Gaussians and tile lists", size.rasterizer_bytes}};
  std::stable_sort(items.begin(), items.end(),
                   [](const MemoryItem& a, const MemoryItem& b) { return a.bytes > b.bytes; });
  return items;
}

int64_t TotalBytes(const std::vector<MemoryItem>& items) {
  int64_t total = 0;
  for (const MemoryItem& item : items) total += item.bytes;
  return total;
}

void RequireMemory(const std::vector<MemoryItem>& items, int64_t free) {
  if (TotalBytes(items) <= free) return;
  std::string parts;
  for (const MemoryItem& item : items) {
    parts += fmt::format("{}{:.2f} for {}", parts.empty() ? "" : ", ", Gigabytes(item.bytes), item.what);
  }
  throw OutOfMemory(
      "training needs about {:.2f} GB of GPU memory ({}), {:.2f} GB are free; lower --max-gaussians, raise "
      "--downscale, "
      "or use --device cpu",
      Gigabytes(TotalBytes(items)), parts, Gigabytes(free));
}

}  // namespace oraclegs
