#include "oraclegs/baselines/ray_modes.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/render/cpu/kernels.h"
#include "oraclegs/render/cpu/tile_lists.h"
#include "oraclegs/render/render_inputs.h"

namespace oraclegs {
namespace {

constexpr int64_t kModeGrain = 1024;  // Gaussians a task

/// log2 of a splat's falloff at a pixel, without its opacity.
float Log2Falloff(const Splat& splat, float x, float y) {
  const float dx = x - splat.mx, dy = y - splat.my;
  const float p = splat.ax * dx, q = splat.by * (dy + splat.slope * dx);
  return -(p * p + q * q);
}

/// Blending state of one pixel.
struct RayBlend {
  float transmittance = 1, best = 0;
  float weight = 0, weighted_depth = 0, mode_depth = 0;
  int64_t first = -1, mode = -1;

  /// Returns false when the pixel is opaque.
  bool Add(const Splat& splat, float alpha, int64_t entry) {
    const float next = transmittance * (1 - alpha);
    if (next < kTransmittanceEnd) return false;
    const float w = alpha * transmittance;
    weight += w;
    weighted_depth += w * splat.depth;
    if (first < 0) first = entry;
    if (w > best) {
      best = w;
      mode = entry;
      mode_depth = splat.depth;
    }
    transmittance = next;
    return true;
  }
};

}  // namespace

struct RayView::Lists {
  SplatCamera<float> camera;
  cpu::ScratchArray<cpu::LineSplat> splats;
  cpu::TileLists tiles;

  int64_t TileOf(int64_t pixel) const {
    return pixel / camera.width / kTile * camera.tiles_x + pixel % camera.width / kTile;
  }
  RayBlend Blend(int64_t pixel) const {
    const float x = static_cast<float>(pixel % camera.width) + 0.5f,
                y = static_cast<float>(pixel / camera.width) + 0.5f;
    const int64_t* begin = tiles.tile_begin.data() + TileOf(pixel);
    RayBlend blend;
    for (int64_t entry = begin[0]; entry < begin[1]; ++entry) {
      const Splat& splat = splats.data()[tiles.entries.data()[entry].id];
      const float log2_alpha = splat.log2_opacity + Log2Falloff(splat, x, y);
      if (log2_alpha < kLog2AlphaMin) continue;
      if (!blend.Add(splat, std::min(kAlphaMax, std::exp2(log2_alpha)), entry)) break;
    }
    return blend;
  }
};

RayView::RayView(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options)
    : lists_(std::make_unique<Lists>()) {
  const GaussianParameters parameters = ForwardParameters(gaussians, camera, options, kCpu);
  const cpu::ProjectInput input = {MakeSplatCamera<float>(camera, options), parameters};
  lists_->camera = input.camera;
  lists_->splats.Reserve(parameters.n);
  std::vector<TileRect> rects(static_cast<size_t>(parameters.n));
  ParallelBlocks(parameters.n, kModeGrain, [&](int64_t begin, int64_t end) {
    cpu::ProjectSplats(input, begin, end, lists_->splats.data(), rects.data());
  });
  lists_->tiles.Build(lists_->splats.data(), rects.data(), parameters.n, input.camera.tiles_x, input.camera.tiles_y);
}

RayView::~RayView() = default;

RayModes RayView::FindModes() const {
  const int64_t width = lists_->camera.width, height = lists_->camera.height;
  const auto pixels = static_cast<size_t>(width * height);
  RayModes modes{std::vector<float>(pixels), std::vector<float>(pixels), std::vector<int64_t>(pixels),
                 std::vector<int64_t>(pixels)};
  ParallelFor(height, [&](int64_t row) {
    for (int64_t i = row * width; i < (row + 1) * width; ++i) {
      const RayBlend blend = lists_->Blend(i);
      modes.mode_depth[i] = blend.mode_depth;
      modes.blended_depth[i] = blend.weight > 0 ? blend.weighted_depth / blend.weight : 0;
      modes.first_entry[i] = blend.first;
      modes.mode_entry[i] = blend.mode;
    }
  });
  return modes;
}

void RayView::MarkUpToMode(const RayModes& modes, int64_t pixel, double min_log_falloff,
                           std::vector<uint8_t>* marked) const {
  if (modes.first_entry[pixel] < 0) return;
  const float x = static_cast<float>(pixel % lists_->camera.width) + 0.5f;
  const float y = static_cast<float>(pixel / lists_->camera.width) + 0.5f;
  const auto limit = static_cast<float>(min_log_falloff) * kLog2E;
  for (int64_t entry = modes.first_entry[pixel]; entry <= modes.mode_entry[pixel]; ++entry) {
    const uint32_t id = lists_->tiles.entries.data()[entry].id;
    if (Log2Falloff(lists_->splats.data()[id], x, y) > limit) (*marked)[id] = 1;
  }
}

}  // namespace oraclegs
