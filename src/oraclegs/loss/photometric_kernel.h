#pragma once
// The photometric loss on plain memory, one task a tile; compiled for several instruction sets and
// chosen at run time.

#include <cstdint>

#include "oraclegs/loss/ssim_window.h"

namespace oraclegs::photometric {

inline constexpr int kRadius = kSsimRadius;
inline constexpr int kTaps = kSsimTaps;
inline constexpr int kMaxTileWidth = 256;  ///< pixels; keeps a tile's rows in the second-level cache
inline constexpr int kRingRows = 16;       ///< rows alive at once; see the plan in photometric_kernel.cpp
inline constexpr int kGroup = 4;           ///< rows that the vertical filter makes at once
inline constexpr int kStride = 57 * 16;    ///< floats a buffered row; an odd number of cache lines
static_assert(kStride >= (kMaxTileWidth + 4 * kRadius) * 3 + 64, "a row, and what the last vector reads past it");

/// Pointers to row-major planes, colors interleaved. A null confidence is 1 everywhere; a null output is not computed.
struct Images {
  int width = 0, height = 0;
  const float* render = nullptr;      ///< [H,W,3]
  const float* target = nullptr;      ///< [H,W,3]
  const float* confidence = nullptr;  ///< [H,W]
  float* grad = nullptr;              ///< [H,W,3] dL/d(render)
  float* ssim = nullptr;              ///< [H,W,3] the SSIM map
  float l1_scale = 0;                 ///< dL/d(sum |render - target| U)
  float dssim_scale = 0;              ///< dL/d(sum (1 - S) U)
};

/// Pixels [x0, x1) x [y0, y1); at most kMaxTileWidth wide.
struct Tile {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Sums over a tile's pixels and channels.
struct TileSums {
  double l1 = 0;     ///< |render - target| U
  double dssim = 0;  ///< (1 - S) U
};

/// Scratch of one tile. Contents need not survive from tile to tile.
struct Scratch {
  enum Plane { kRender, kTarget, kSquares, kProduct, kConfidence, kInputPlanes };
  enum Coefficient { kMean, kVariance, kCovariance, kCoefficients };
  static constexpr int kFiltered = kConfidence;  ///< the planes before it go through the window

  alignas(64) float input[kInputPlanes][kRingRows][kStride];      ///< column 0 is pixel x0 - 2 kRadius
  alignas(64) float backward[kCoefficients][kRingRows][kStride];  ///< column 0 is pixel x0
  alignas(64) float vertical[kFiltered][kGroup][kStride];         ///< as input
  alignas(64) float coefficient[kCoefficients][kStride];          ///< column 0 is pixel x0 - kRadius
  alignas(64) float ssim[kStride];                                ///< as coefficient
};

/// Returns the sums of one tile and writes the requested outputs, only at the tile's pixels.
TileSums RunTile(const Images& images, const Tile& tile, Scratch* scratch);

}  // namespace oraclegs::photometric
