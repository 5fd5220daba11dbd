#pragma once
// The CPU rasteriser's kernels on plain memory, each compiled for several instruction sets and chosen at run time.
//
// Work is laid out in tiles of 16 x 16 pixels, each of 16 blocks of 4 x 4: one block is one AVX-512 vector. A
// (tile, Gaussian) pair carries a 16-bit mask of the blocks the Gaussian reaches.

#include <cstdint>

#include "oraclegs/gaussians/gaussian_rows.h"

namespace oraclegs::cpu {

inline constexpr int kTile = 16;  ///< pixels a side
inline constexpr int kBlock = 4;  ///< pixels a side
inline constexpr int kTilePixels = kTile * kTile;
inline constexpr int kBlocksPerTile = 16;
inline constexpr int kGradStride = 16;  ///< floats of one pair's gradient record (one cache line)

/// One Gaussian as the blend loop reads it. The falloff is exp2(log2_opacity + qxx dx^2 + qxy dx dy + qyy dy^2), d from
/// the centre in pixels; log2(e) and the factors 1/2 are folded into q.
struct Splat {
  float mx, my;         ///< px, whole image
  float qxx, qxy, qyy;  ///< <= 0 on the diagonal
  float log2_opacity;
  float r, g, b;
  float inv_z;
  float depth;
  float opacity;
};
static_assert(sizeof(Splat) == 48);

/// Tiles that a Gaussian may reach: [x0, x1) x [y0, y1). Empty: not visible.
struct TileRect {
  uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int Count() const { return (x1 - x0) * (y1 - y0); }
};

/// One Gaussian in one tile.
struct TileEntry {
  uint32_t id;    ///< Gaussian
  uint32_t mask;  ///< bit by * 4 + bx: reaches block (bx, by)
};

/// Everything the per-Gaussian kernels need of a view, all pointers to N rows.
struct ProjectInput {
  const float *means, *log_scales, *quats, *opacity_logits, *sh;
  float r[9], t[3], eye[3];
  float fx, fy, cx, cy, min_u, max_u, min_v, max_v;
  int width, height, tiles_x, tiles_y;
  int sh_degree;
  bool antialiased;
};

/// Projects Gaussians [begin, end): fills splats and rects (empty where invisible).
void ProjectSplats(const ProjectInput& in, int64_t begin, int64_t end, Splat* splats, TileRect* rects);

/// Which of the 16 blocks of tile (tx, ty) hold a pixel where alpha may reach 1/255. Conservative.
/// Writes entries for the tiles of `rect` that have one, and their tile numbers; returns how many.
int64_t CoveredTiles(const Splat& splat, const TileRect& rect, uint32_t id, int tiles_x, TileEntry* entries,
                     uint32_t* tiles);

/// The image planes and what the backward pass needs.
struct BlendImage {
  int width, height;
  float background[3];
  float* image;          ///< [H,W,3]
  float* alpha;          ///< [H,W]
  float* inv_depth;      ///< [H,W]
  float* transmittance;  ///< [tiles, 16 blocks, 16 pixels] final T, or null
  uint32_t* last;        ///< the same layout: 1 + position in the tile's list of the last contributor, or null
};

/// Blends one tile's list, near to far (spec/gaussian_core.md 4).
void BlendTile(const Splat* splats, const TileEntry* entries, int64_t count, int tile_x, int tile_y, int64_t tile,
               const BlendImage& out);

/// dL/d(image planes); a null pointer means zero.
struct BlendUpstream {
  const float *image, *alpha, *inv_depth;
};

/// Adjoint of BlendTile. Writes one record of kGradStride floats for each of the tile's entries. With X, Y a pixel's
/// offset from the tile's centre, h = alpha dL/d(alpha) (0 where capped), w = alpha T:
/// [0] sum h  [1] h X  [2] h Y  [3] h X^2  [4] h X Y  [5] h Y^2  [8..10] w dL/d(rgb)  [11] w dL/d(inv_depth)
void BlendTileBackward(const Splat* splats, const TileEntry* entries, int64_t count, int tile_x, int tile_y,
                       int64_t tile, const BlendImage& forward, const BlendUpstream& upstream, float* records);

/// Where one Gaussian's records lie.
struct PairRange {
  uint32_t begin = 0, count = 0;  ///< into pair_slot and pair_tile
};

struct GradInput {
  const PairRange* ranges;    ///< [N], count 0 = unseen
  const uint32_t* pair_slot;  ///< position of the record
  const uint32_t* pair_tile;  ///< tile number, for its centre
  const float* records;
  const Splat* splats;
};

/// Sums the records of Gaussians [begin, end) in a fixed order and carries them back to the raw parameters. `out` holds
/// their rows, the first one for `begin`; coefficients of sh above the active degree are not written.
void ProjectSplatsBackward(const ProjectInput& in, const GradInput& grads, int64_t begin, int64_t end,
                           const GaussianRows& out);

}  // namespace oraclegs::cpu
