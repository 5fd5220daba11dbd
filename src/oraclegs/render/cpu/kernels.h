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

/// One Gaussian as the blend loop reads it. With d = pixel - centre its falloff is
/// exp2(log2_opacity - (ax dx)^2 - (by (dy + slope dx))^2): the quadratic form of the inverse covariance, written as a
/// sum of squares. It needs no more operations, never exceeds its peak, and keeps its digits on needles, where the
/// three terms of the form itself cancel. log2(e) and the factor 1/2 are inside ax and by.
struct alignas(64) Splat {
  float mx, my;         ///< px, whole image
  float ax, by, slope;  ///< ax^2 = log2(e)/2 / cov_xx, by^2 = log2(e)/2 conic_yy (1/px^2), slope = -cov_xy / cov_xx
  float log2_opacity;
  float r, g, b;
  float inv_z;
  float depth;
};
static_assert(sizeof(Splat) == 64);
inline constexpr int kSplatFields = 11;

/// Tiles that a Gaussian may reach: [x0, x1) x [y0, y1). Empty: not visible.
struct TileRect {
  uint16_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int Count() const { return (x1 - x0) * (y1 - y0); }
};

/// One Gaussian in one tile.
struct TileEntry {
  uint32_t id;    ///< Gaussian
  uint32_t mask;  ///< bit by * 4 + bx: reaches block (bx, by)
  uint32_t pair;  ///< number of this pair, Gaussian by Gaussian: where its gradient record lies
};

/// Everything the per-Gaussian kernels need of a view, all pointers to N rows.
struct ProjectInput {
  const float *means, *log_scales, *quats, *opacity_logits, *sh;
  const float* opacity_factors;  ///< or null: all are 1; the backward pass needs none
  float r[9], t[3], eye[3];
  float fx, fy, cx, cy, min_u, max_u, min_v, max_v;
  int width, height, tiles_x, tiles_y;
  int sh_degree;
  bool antialiased;
};

/// Projects Gaussians [begin, end): fills splats and rects (empty where invisible).
void ProjectSplats(const ProjectInput& in, int64_t begin, int64_t end, Splat* splats, TileRect* rects);

/// Where one Gaussian's pairs lie.
struct PairRange {
  uint32_t begin = 0, count = 0;  ///< into pair_tile and the records
};

/// What CoverTiles writes, each with room for what `rects` hold.
struct CoverOutput {
  uint32_t* pair_tile;  ///< tile number, Gaussian by Gaussian
  uint32_t* pair_mask;  ///< its blocks, as TileEntry::mask; never 0
  PairRange* ranges;    ///< of Gaussian i, empty if it reaches none
};

/// Which blocks of which tiles of their rectangle Gaussians [begin, end) reach: those that hold a point between their
/// pixel centres where alpha may be 1/255. Conservative. Writes pairs from `first_pair` on; returns the next free one.
uint32_t CoverTiles(const Splat* splats, const TileRect* rects, int64_t begin, int64_t end, int tiles_x,
                    uint32_t first_pair, const CoverOutput& out);

/// The image planes and what the backward pass needs.
struct BlendImage {
  int width, height;
  float background[3];
  float* image;          ///< [H,W,3]
  float* alpha;          ///< [H,W]
  float* inv_depth;      ///< [H,W]
  float* transmittance;  ///< [tiles, 16 blocks, 16 pixels] final T, or null
  uint32_t* end;         ///< the same layout, or null: the step of the block's list from which on the pixel takes no
                         ///< part, 0 if it never does. Numbered by the kernels
};

/// A tile's list and place.
struct TileWork {
  const Splat* splats;       ///< all of them
  const TileEntry* entries;  ///< of this tile, near to far
  int64_t count;             ///< entries
  int64_t next_count;        ///< of the tile after it, whose entries follow; they may be asked for ahead
  int x, y;                  ///< column and row of the tile
  int64_t index;             ///< among the image's tiles
};

/// Blends one tile's list, near to far (docs/method.md#blending). Returns how many pixel-Gaussian pairs it evaluated:
/// 16 for each block and Gaussian that reaches it, until the block is opaque.
int64_t BlendTile(const TileWork& tile, const BlendImage& out);

/// dL/d(image planes); a null pointer means zero.
struct BlendUpstream {
  const float *image, *alpha, *inv_depth;
};

/// Adjoint of BlendTile. Writes one record of kGradStride floats for each of the tile's entries, at its pair's place in
/// `records`: this stage computes and has time to reach for memory, the next one reads all it can. With X, Y a pixel's
/// offset from the tile's centre, h = alpha dL/d(alpha) (0 where capped), w = alpha T:
/// [0] sum h  [1] h X  [2] h Y  [3] h X^2  [4] h X Y  [5] h Y^2  [8..10] w dL/d(rgb)  [11] w dL/d(inv_depth)
/// Returns how many pixel-Gaussian pairs it evaluated.
int64_t BlendTileBackward(const TileWork& tile, const BlendImage& forward, const BlendUpstream& upstream,
                          float* records);

struct GradInput {
  const PairRange* ranges;    ///< [N], count 0 = unseen
  const uint32_t* pair_tile;  ///< tile number, for its centre
  const float* records;       ///< one a pair
  const Splat* splats;
};

/// Sums the records of Gaussians [begin, end) in a fixed order and carries them back to the raw parameters. `out` holds
/// their rows, the first one for `begin`; coefficients of sh above the active degree are not written.
void ProjectSplatsBackward(const ProjectInput& in, const GradInput& grads, int64_t begin, int64_t end,
                           const GaussianRows& out);

}  // namespace oraclegs::cpu
