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

inline constexpr int kBlock = 4;  ///< pixels per side
inline constexpr int kBlocksPerTile = 16;
inline constexpr int kGradStride = 16;  ///< floats of one pair's gradient record (one cache line)

/// A splat that fills a cache line, since splats are scattered in memory when a tile reads them.
struct alignas(64) LineSplat : Splat {};
static_assert(sizeof(LineSplat) == 64);
inline constexpr int kSplatFields = sizeof(Splat) / sizeof(float);

/// One Gaussian in one tile.
struct TileEntry {
  uint32_t id;    ///< Gaussian
  uint32_t mask;  ///< bit by * 4 + bx: reaches block (bx, by)
  uint32_t pair;  ///< number of this pair, Gaussian by Gaussian: the place of its gradient record
};

/// View and parameters for the per-Gaussian kernels.
struct ProjectInput {
  SplatCamera<float> camera;
  GaussianParameters gaussians;
};

/// Projects Gaussians [begin, end): fills splats and rects (empty where invisible).
void ProjectSplats(const ProjectInput& in, int64_t begin, int64_t end, LineSplat* splats, TileRect* rects);

/// A Gaussian's pairs.
struct PairRange {
  uint32_t begin = 0, count = 0;  ///< range in pair_tile and in the records
};

struct CoverInput {
  const LineSplat* splats;
  const TileRect* rects;
  int tiles_x;
};

/// Output of CoverTiles. Each array has room for every tile of `rects`.
struct CoverOutput {
  uint32_t* pair_tile;  ///< tile number, Gaussian by Gaussian
  uint32_t* pair_mask;  ///< blocks of the tile, as TileEntry::mask; never 0
  PairRange* ranges;    ///< [N] pairs of each Gaussian, empty if it reaches none
};

/// Finds the blocks that Gaussians [begin, end) reach in the tiles of their rectangles: those that hold a point between
/// their pixel centers where alpha may be 1/255. Conservative. Writes pairs from `first_pair` on; returns the next free
/// one.
uint32_t CoverTiles(const CoverInput& in, int64_t begin, int64_t end, uint32_t first_pair, const CoverOutput& out);

/// The image planes, and planes that the backward pass reads.
struct BlendImage {
  int width, height;
  float background[3];
  float* image;          ///< [H,W,3]
  float* alpha;          ///< [H,W]
  float* inv_depth;      ///< [H,W]
  float* transmittance;  ///< [tiles, 16 blocks, 16 pixels] final T, or null
  uint32_t* end;  ///< [tiles, 16 blocks, 16 pixels] first step of the block's list that does not contribute to the
                  ///< pixel, 0 if none does, or null. Numbered by the kernels
};

/// A tile's list and position.
struct TileWork {
  const LineSplat* splats;   ///< splats of all Gaussians
  const TileEntry* entries;  ///< entries of this tile, near to far
  int64_t count;             ///< number of entries
  int64_t next_count;        ///< entries of the next tile, which follow; they may be prefetched
  int x, y;                  ///< column and row of the tile
  int64_t index;             ///< among the image's tiles
};

/// Blends one tile's list, near to far (docs/method.md#blending). Returns how many pixel-Gaussian pairs it evaluated:
/// 16 for each block and Gaussian that reaches it, until the block is opaque.
int64_t BlendTile(const TileWork& tile, const BlendImage& out);

/// Adjoint of BlendTile. Writes one record of kGradStride floats for each of the tile's entries, at its pair's place in
/// `records`: this stage is bound by computation and can wait for memory, the next one is bound by memory. Returns how
/// many pixel-Gaussian pairs it evaluated.
/// With X, Y a pixel's offset from the tile's center, h = alpha dL/d(alpha) (0 where capped), w = alpha T, a record is:
/// [0] sum h  [1] h X  [2] h Y  [3] h X^2  [4] h X Y  [5] h Y^2  [8..10] w dL/d(rgb)  [11] w dL/d(inv_depth)
int64_t BlendTileBackward(const TileWork& tile, const BlendImage& forward, const UpstreamPlanes& upstream,
                          float* records);

struct GradInput {
  const PairRange* ranges;    ///< [N], count 0 = unseen
  const uint32_t* pair_tile;  ///< tile number, for its center
  const float* records;       ///< one a pair
  const LineSplat* splats;
  float* screen_sums = nullptr;   ///< [N] added to ScreenGradients::sum
  float* screen_views = nullptr;  ///< [N] added to ScreenGradients::views; null = not watched
  float* camera_sums = nullptr;   ///< [kCameraSums] sums over the Gaussians of one call; null = not watched
};

/// Sums the records of Gaussians [begin, end) in a fixed order and propagates them to the raw parameters. `out` holds
/// their rows, the first one for `begin`; coefficients of sh above the active degree are not written.
void ProjectSplatsBackward(const ProjectInput& in, const GradInput& grads, int64_t begin, int64_t end,
                           const GaussianRows& out);

}  // namespace oraclegs::cpu
