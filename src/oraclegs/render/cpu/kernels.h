#pragma once
// The CPU rasterizer's kernels on plain memory, each compiled for several instruction sets and chosen at run time.
//
// Work is laid out in tiles of 16 x 16 pixels, each of 16 blocks of 4 x 4: one block is one AVX-512 vector. A
// (tile, Gaussian) pair carries a 16-bit mask of the blocks the Gaussian reaches.

#include <cstdint>

#include "oraclegs/gaussians/gaussian_rows.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/render/splat_camera.h"
#include "oraclegs/render/splats.h"

namespace oraclegs::cpu {

inline constexpr int kBlock = 4;  ///< pixels a side
inline constexpr int kBlocksPerTile = 16;
inline constexpr int kGradStride = 16;  ///< floats of one pair's gradient record (one cache line)

/// A splat that fills a cache line: they lie anywhere in memory when a tile reads them.
struct alignas(64) LineSplat : Splat {};
static_assert(sizeof(LineSplat) == 64);
inline constexpr int kSplatFields = sizeof(Splat) / sizeof(float);

/// One Gaussian in one tile.
struct TileEntry {
  uint32_t id;    ///< Gaussian
  uint32_t mask;  ///< bit by * 4 + bx: reaches block (bx, by)
  uint32_t pair;  ///< number of this pair, Gaussian by Gaussian: where its gradient record lies
};

/// Everything the per-Gaussian kernels need of a view.
struct ProjectInput {
  SplatCamera<float> camera;
  GaussianParameters gaussians;
};

/// Projects Gaussians [begin, end): fills splats and rects (empty where invisible).
void ProjectSplats(const ProjectInput& in, int64_t begin, int64_t end, LineSplat* splats, TileRect* rects);

/// Where one Gaussian's pairs lie.
struct PairRange {
  uint32_t begin = 0, count = 0;  ///< into pair_tile and the records
};

struct CoverInput {
  const LineSplat* splats;
  const TileRect* rects;
  int tiles_x;
};

/// What CoverTiles writes, each with room for what `rects` hold.
struct CoverOutput {
  uint32_t* pair_tile;  ///< tile number, Gaussian by Gaussian
  uint32_t* pair_mask;  ///< its blocks, as TileEntry::mask; never 0
  PairRange* ranges;    ///< of Gaussian i, empty if it reaches none
};

/// Which blocks of which tiles of their rectangle Gaussians [begin, end) reach: those that hold a point between their
/// pixel centers where alpha may be 1/255. Conservative. Writes pairs from `first_pair` on; returns the next free one.
uint32_t CoverTiles(const CoverInput& in, int64_t begin, int64_t end, uint32_t first_pair, const CoverOutput& out);

/// The image planes and what the backward pass needs.
struct BlendImage {
  int width, height;
  float background[3];
  float* image;          ///< [H,W,3]
  float* alpha;          ///< [H,W]
  float* inv_depth;      ///< [H,W]
  float* transmittance;  ///< [tiles, 16 blocks, 16 pixels] final T, or null
  uint32_t* end;         ///< the same layout, or null: the first step of the block's list that does not contribute to
                         ///< the pixel, 0 if none does. Numbered by the kernels
};

/// A tile's list and place.
struct TileWork {
  const LineSplat* splats;   ///< all of them
  const TileEntry* entries;  ///< of this tile, near to far
  int64_t count;             ///< entries
  int64_t next_count;        ///< of the tile after it, whose entries follow; they may be prefetched
  int x, y;                  ///< column and row of the tile
  int64_t index;             ///< among the image's tiles
};

/// Blends one tile's list, near to far (docs/method.md#blending). Returns how many pixel-Gaussian pairs it evaluated:
/// 16 for each block and Gaussian that reaches it, until the block is opaque.
int64_t BlendTile(const TileWork& tile, const BlendImage& out);

/// Adjoint of BlendTile. Writes one record of kGradStride floats for each of the tile's entries, at its pair's place in
/// `records`: this stage is bound by computation and can wait for memory, the next one is bound by memory. With X, Y a
/// pixel's offset from the tile's center, h = alpha dL/d(alpha) (0 where capped), w = alpha T: [0] sum h  [1] h X  [2]
/// h Y  [3] h X^2  [4] h X Y  [5] h Y^2  [8..10] w dL/d(rgb)  [11] w dL/d(inv_depth) Returns how many pixel-Gaussian
/// pairs it evaluated.
int64_t BlendTileBackward(const TileWork& tile, const BlendImage& forward, const UpstreamPlanes& upstream,
                          float* records);

struct GradInput {
  const PairRange* ranges;    ///< [N], count 0 = unseen
  const uint32_t* pair_tile;  ///< tile number, for its center
  const float* records;       ///< one a pair
  const LineSplat* splats;
  float* screen_sums = nullptr;   ///< [N] ScreenGradients::sum and
  float* screen_views = nullptr;  ///< views, which are added to; null = nobody wants them
};

/// Sums the records of Gaussians [begin, end) in a fixed order and carries them back to the raw parameters. `out` holds
/// their rows, the first one for `begin`; coefficients of sh above the active degree are not written.
void ProjectSplatsBackward(const ProjectInput& in, const GradInput& grads, int64_t begin, int64_t end,
                           const GaussianRows& out);

}  // namespace oraclegs::cpu
