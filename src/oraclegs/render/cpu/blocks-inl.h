// Blocks of 4 x 4 pixels: their places, and copies between image planes and vector lanes.

#if defined(ORACLEGS_RENDER_CPU_BLOCKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ORACLEGS_RENDER_CPU_BLOCKS_INL_H_
#undef ORACLEGS_RENDER_CPU_BLOCKS_INL_H_
#else
#define ORACLEGS_RENDER_CPU_BLOCKS_INL_H_
#endif

#include <algorithm>
#include <cstring>

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/render/cpu/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {

/// Vectors that make up a block of 16 pixels.
inline constexpr int kVecs = 16 / kLanes;

/// Centers of the 16 pixels of each block, relative to the tile's center.
struct BlockCenters {
  HWY_ALIGN float x[cpu::kBlocksPerTile][16], y[cpu::kBlocksPerTile][16];
};
constexpr BlockCenters MakeBlockCenters() {
  BlockCenters c{};
  for (int block = 0; block < cpu::kBlocksPerTile; ++block) {
    for (int i = 0; i < 16; ++i) {
      c.x[block][i] = static_cast<float>(block % 4 * cpu::kBlock + i % cpu::kBlock - kTile / 2) + 0.5f;
      c.y[block][i] = static_cast<float>(block / 4 * cpu::kBlock + i / cpu::kBlock - kTile / 2) + 0.5f;
    }
  }
  return c;
}
HWY_ALIGN inline constexpr BlockCenters kBlockCenters = MakeBlockCenters();

/// The part of a block that lies inside the image.
struct BlockPlace {
  int64_t first;      ///< pixel number of its first pixel
  int width;          ///< width of the image
  int columns, rows;  ///< at most 4, and both at least 1 unless empty

  HWY_INLINE BlockPlace(const cpu::TileWork& tile, int block, int image_width, int image_height) {
    const int x0 = tile.x * kTile + block % 4 * cpu::kBlock, y0 = tile.y * kTile + block / 4 * cpu::kBlock;
    first = static_cast<int64_t>(y0) * image_width + x0;
    width = image_width;
    columns = std::min(cpu::kBlock, image_width - x0);
    rows = std::min(cpu::kBlock, image_height - y0);
  }
  HWY_INLINE bool Empty() const { return columns <= 0 || rows <= 0; }
  HWY_INLINE bool Whole() const { return columns == cpu::kBlock && rows == cpu::kBlock; }
  HWY_INLINE bool Holds(int i) const { return i % cpu::kBlock < columns && i / cpu::kBlock < rows; }
};

/// Copies the block's pixels of a plane of kChannels floats a pixel to `packed`; entries of pixels outside the image
/// stay.
template <int kChannels>
HWY_INLINE void CopyFromPlane(const float* HWY_RESTRICT plane, const BlockPlace& at, float* HWY_RESTRICT packed) {
  constexpr int kRow = cpu::kBlock * kChannels;
  const float* from = plane + at.first * kChannels;
  if (HWY_LIKELY(at.Whole())) {
    for (int y = 0; y < cpu::kBlock; ++y) {
      std::memcpy(packed + y * kRow, from + static_cast<int64_t>(y) * at.width * kChannels, kRow * sizeof(float));
    }
    return;
  }
  for (int y = 0; y < at.rows; ++y) {
    std::copy_n(from + static_cast<int64_t>(y) * at.width * kChannels, at.columns * kChannels, packed + y * kRow);
  }
}

/// Copies `packed` back to the plane; pixels outside the image are skipped.
template <int kChannels>
HWY_INLINE void CopyToPlane(const float* HWY_RESTRICT packed, const BlockPlace& at, float* HWY_RESTRICT plane) {
  constexpr int kRow = cpu::kBlock * kChannels;
  float* to = plane + at.first * kChannels;
  if (HWY_LIKELY(at.Whole())) {
    for (int y = 0; y < cpu::kBlock; ++y) {
      std::memcpy(to + static_cast<int64_t>(y) * at.width * kChannels, packed + y * kRow, kRow * sizeof(float));
    }
    return;
  }
  for (int y = 0; y < at.rows; ++y) {
    std::copy_n(packed + y * kRow, at.columns * kChannels, to + static_cast<int64_t>(y) * at.width * kChannels);
  }
}

/// Prefetches the block's lines of a plane for writing.
template <int kChannels>
HWY_INLINE void PrefetchPlane(const float* plane, const BlockPlace& at) {
  for (int y = 0; y < at.rows; ++y) {
    __builtin_prefetch(plane + (at.first + static_cast<int64_t>(y) * at.width) * kChannels, 1);
  }
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
