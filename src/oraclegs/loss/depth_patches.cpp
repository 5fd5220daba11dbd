#include "oraclegs/loss/depth_losses.h"

#include <algorithm>

#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

void CheckPatchSide(const char* who, int64_t height, int64_t width, int64_t side) {
  if (height < 1 || width < 1) throw ShapeError("{}: the image is {} x {}", who, width, height);
  if (side < 1) throw ShapeError("{}: a patch has {} pixels a side", who, side);
}

}  // namespace

void DepthImages::Check(const char* who, const Buffer<float>* grad) const {
  RequireShape(who, "rendered", rendered, {-1, -1});
  RequireShape(who, "target", target, {height(), width()});
  if (mask.defined()) RequireShape(who, "mask", mask, {height(), width()});
  if (grad != nullptr && grad->defined()) RequireShape(who, "grad", *grad, {height(), width()});
  if (rendered.count() == 0) throw ShapeError("{}: rendered is empty", who);
}

std::vector<ImagePatch> RandomPatches(int64_t height, int64_t width, const PatchSampling& sampling, uint64_t seed,
                                      int64_t iteration) {
  CheckPatchSide("RandomPatches", height, width, sampling.side);
  const int64_t patch_height = std::min(sampling.side, height), patch_width = std::min(sampling.side, width);
  const auto tiles = static_cast<double>((height / patch_height) * (width / patch_width));
  const int64_t count = std::max<int64_t>(1, static_cast<int64_t>(sampling.share * tiles));
  // Iterations lie 2^32 draws apart, so that none reads the draws of another.
  Rng rng(seed, RandomStream::kDepthPatches, static_cast<uint64_t>(iteration) << 32);
  std::vector<ImagePatch> patches;
  patches.reserve(static_cast<size_t>(count));
  for (int64_t k = 0; k < count; ++k) {
    const int64_t y = rng.Index(height - patch_height + 1), x = rng.Index(width - patch_width + 1);
    patches.push_back({x, y, patch_width, patch_height});
  }
  return patches;
}

std::vector<ImagePatch> GridPatches(int64_t height, int64_t width, int64_t side) {
  CheckPatchSide("GridPatches", height, width, side);
  const int64_t patch_height = std::min(side, height), patch_width = std::min(side, width);
  std::vector<ImagePatch> patches;
  for (int64_t y = 0; y + patch_height <= height; y += patch_height) {
    for (int64_t x = 0; x + patch_width <= width; x += patch_width) {
      patches.push_back({x, y, patch_width, patch_height});
    }
  }
  return patches;
}

}  // namespace oraclegs
