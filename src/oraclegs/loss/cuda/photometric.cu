// Two passes over tiles of 32 x 16 pixels, a channel at a time: the statistics of every window and the derivatives of
// the loss by them; then the window over those derivatives. A tile and its halo lie in shared memory. The window goes
// along the rows first, four columns to a thread (14 reads serve 44 multiplications), then down the columns, two rows
// to a thread.

#include "oraclegs/loss/cuda/photometric.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/core/cuda/sums-inl.cuh"
#include "oraclegs/loss/ssim_math-inl.h"
#include "oraclegs/loss/ssim_window.h"

namespace oraclegs::cuda {
namespace {

constexpr int kTileWidth = kPhotometricTileWidth, kTileHeight = kPhotometricTileHeight;
constexpr int kHaloRows = kTileHeight + 2 * kSsimRadius, kHaloColumns = kTileWidth + 2 * kSsimRadius;
constexpr int kHaloStride = 43;     // coprime to 32 in such a way that the four rows a warp reads share no bank
constexpr int kColumnsAThread = 4;  // of the horizontal window
constexpr int kRowsAThread = 2;     // of the vertical window
constexpr int kRunsARow = kTileWidth / kColumnsAThread;
static_assert(kSumThreads == kTileWidth * kTileHeight / kRowsAThread);
static_assert(kHaloRows * kRunsARow <= kSumThreads);

/// Weight k of the window; a constant once the loops are unrolled.
__device__ float SsimTap(int k) {
  constexpr float kHalf[kSsimRadius + 1] = {static_cast<float>(kSsimWindow[0]), static_cast<float>(kSsimWindow[1]),
                                            static_cast<float>(kSsimWindow[2]), static_cast<float>(kSsimWindow[3]),
                                            static_cast<float>(kSsimWindow[4]), static_cast<float>(kSsimWindow[5])};
  return kHalf[k < kSsimRadius ? kSsimRadius - k : k - kSsimRadius];
}

/// Channels of one round, [first, end).
struct Channels {
  int first, end;
};

/// One channel of a tile with its halo; row 0, column 0 is pixel (x0 - radius, y0 - radius).
using HaloPlane = float[kHaloRows][kHaloStride];
/// A HaloPlane after the horizontal window: only the tile's own columns, four per item.
using RowsPlane = float4[kHaloRows][kRunsARow];

struct PixelPair {
  float render = 0, target = 0;
};

/// A pixel's channel; zero outside the image.
__device__ PixelPair LoadPixel(const PhotometricInput& in, int x, int y, int channel) {
  PixelPair pair;
  if (x < 0 || y < 0 || x >= in.width || y >= in.height) return pair;
  const int64_t pixel = static_cast<int64_t>(y) * in.width + x;
  pair.target = in.target.At(3 * pixel + channel);
  const bool hidden = in.meaning == MaskMeaning::kMask && in.confidence.is_there() && !(in.confidence.At(pixel) > 0);
  pair.render = hidden ? pair.target : in.render[3 * pixel + channel];
  return pair;
}

/// Applies the window along kColumnsAThread neighboring columns of kPlanes planes; read(c, values) gives the planes'
/// values at column c. Each value is read once and added to all windows that hold it.
template <int kPlanes, class Read>
__device__ void FilterRun(const Read& read, int row, int run, RowsPlane* out) {
  float sums[kPlanes][kColumnsAThread] = {};
#pragma unroll
  for (int n = 0; n < kColumnsAThread + kSsimTaps - 1; ++n) {
    float values[kPlanes];
    read(run * kColumnsAThread + n, values);
#pragma unroll
    for (int i = 0; i < kColumnsAThread; ++i) {
      const int k = n - i;
      if (k < 0 || k >= kSsimTaps) continue;
#pragma unroll
      for (int plane = 0; plane < kPlanes; ++plane) sums[plane][i] += SsimTap(k) * values[plane];
    }
  }
#pragma unroll
  for (int plane = 0; plane < kPlanes; ++plane) {
    out[plane][row][run] = make_float4(sums[plane][0], sums[plane][1], sums[plane][2], sums[plane][3]);
  }
}

/// Applies the window down one column, to kRowsAThread rows from `row` on.
__device__ void FilterColumn(const RowsPlane& in, int row, int column, float* out) {
  const float* values = reinterpret_cast<const float*>(in[row]) + column;
  for (int r = 0; r < kRowsAThread; ++r) out[r] = 0;
#pragma unroll
  for (int n = 0; n < kRowsAThread + kSsimTaps - 1; ++n) {
    const float value = values[n * kTileWidth];
#pragma unroll
    for (int r = 0; r < kRowsAThread; ++r) {
      const int k = n - r;
      if (k >= 0 && k < kSsimTaps) out[r] += SsimTap(k) * value;
    }
  }
}

/// First pass: the tile's sums and, if requested, the derivatives.
__global__ void __launch_bounds__(kSumThreads, 4)
    PhotometricStatistics(PhotometricInput in, PhotometricOutput out, Channels channels) {
  __shared__ HaloPlane render, target;
  __shared__ RowsPlane rows[4];
  __shared__ double sums[kSumWarps];
  const int thread = static_cast<int>(threadIdx.x);
  const int columns = (in.width + kTileWidth - 1) / kTileWidth;
  const int x0 = static_cast<int>(blockIdx.x) % columns * kTileWidth;
  const int y0 = static_cast<int>(blockIdx.x) / columns * kTileHeight;
  const int column = thread % kTileWidth, row = thread / kTileWidth * kRowsAThread;
  const int x = x0 + column;
  const int64_t pixels = static_cast<int64_t>(in.width) * in.height;
  float l1 = 0, dssim = 0;  // of a few pixels
  for (int channel = channels.first; channel < channels.end; ++channel) {
#pragma unroll 3  // more would need more registers than four blocks a multiprocessor leave
    for (int i = thread; i < kHaloRows * kHaloColumns; i += kSumThreads) {
      const int r = i / kHaloColumns, c = i % kHaloColumns;
      const PixelPair pair = LoadPixel(in, x0 + c - kSsimRadius, y0 + r - kSsimRadius, channel);
      render[r][c] = pair.render;
      target[r][c] = pair.target;
    }
    __syncthreads();
    if (thread < kHaloRows * kRunsARow) {
      const int r = thread / kRunsARow;
      const auto read = [&](int c, float* values) {
        const float a = render[r][c], b = target[r][c];
        values[0] = a, values[1] = b, values[2] = a * a + b * b, values[3] = a * b;
      };
      FilterRun<4>(read, r, thread % kRunsARow, rows);
    }
    __syncthreads();
    float filtered[4][kRowsAThread];
    for (int plane = 0; plane < 4; ++plane) FilterColumn(rows[plane], row, column, filtered[plane]);
    for (int r = 0; r < kRowsAThread; ++r) {
      const int y = y0 + row + r;
      if (x >= in.width || y >= in.height) continue;
      const int64_t pixel = static_cast<int64_t>(y) * in.width + x;
      const float u = in.confidence.is_there() ? in.confidence.At(pixel) : 1.f;
      const SsimPoint<float> s =
          EvaluateSsim(SsimMoments<float>{filtered[0][r], filtered[1][r], filtered[2][r], filtered[3][r]});
      const float away =
          render[row + r + kSsimRadius][column + kSsimRadius] - target[row + r + kSsimRadius][column + kSsimRadius];
      l1 += (away < 0 ? -away : away) * u;
      dssim += (1 - s.ssim) * u;
      if (out.derivatives == nullptr) continue;
      const float g = -2 * in.dssim_scale * u;
      float* to = out.derivatives + 3 * (channel - channels.first) * pixels + pixel;
      to[0] = g * s.mean;
      to[pixels] = g * s.variance;
      to[2 * pixels] = g * s.covariance;
    }
    __syncthreads();
  }
  PhotometricSums of_block{BlockSum(l1, thread, sums), BlockSum(dssim, thread, sums)};
  if (thread != 0) return;
  PhotometricSums* const of_tile = out.sums + blockIdx.x;
  if (channels.first > 0) of_block.l1 += of_tile->l1, of_block.dssim += of_tile->dssim;
  *of_tile = of_block;
}

/// Second pass: dL/d(render) = window(mean) + render * window(variance) + target * window(covariance) + L1's.
__global__ void PhotometricGradient(PhotometricInput in, PhotometricOutput out, Channels channels) {
  __shared__ HaloPlane derivatives[3];
  __shared__ RowsPlane rows[3];
  const int thread = static_cast<int>(threadIdx.x);
  const int columns = (in.width + kTileWidth - 1) / kTileWidth;
  const int x0 = static_cast<int>(blockIdx.x) % columns * kTileWidth;
  const int y0 = static_cast<int>(blockIdx.x) / columns * kTileHeight;
  const int column = thread % kTileWidth, row = thread / kTileWidth * kRowsAThread;
  const int x = x0 + column;
  const int64_t pixels = static_cast<int64_t>(in.width) * in.height;
  for (int channel = channels.first; channel < channels.end; ++channel) {
    const float* from = out.derivatives + 3 * (channel - channels.first) * pixels;
    for (int i = thread; i < kHaloRows * kHaloColumns; i += kSumThreads) {
      const int r = i / kHaloColumns, c = i % kHaloColumns;
      const int px = x0 + c - kSsimRadius, py = y0 + r - kSsimRadius;
      const bool inside = px >= 0 && py >= 0 && px < in.width && py < in.height;
      const int64_t pixel = static_cast<int64_t>(py) * in.width + px;
      for (int k = 0; k < 3; ++k) derivatives[k][r][c] = inside ? from[k * pixels + pixel] : 0.f;
    }
    __syncthreads();
    if (thread < kHaloRows * kRunsARow) {
      const int r = thread / kRunsARow;
      const auto read = [&](int c, float* values) {
        for (int k = 0; k < 3; ++k) values[k] = derivatives[k][r][c];
      };
      FilterRun<3>(read, r, thread % kRunsARow, rows);
    }
    __syncthreads();
    float filtered[3][kRowsAThread];
    for (int k = 0; k < 3; ++k) FilterColumn(rows[k], row, column, filtered[k]);
    for (int r = 0; r < kRowsAThread; ++r) {
      const int y = y0 + row + r;
      if (x >= in.width || y >= in.height) continue;
      const int64_t pixel = static_cast<int64_t>(y) * in.width + x;
      const auto [a, b] = LoadPixel(in, x, y, channel);
      const float u = in.confidence.is_there() ? in.confidence.At(pixel) : 1.f;
      const float l1 = in.l1_scale * u * (static_cast<float>(a > b) - static_cast<float>(a < b));
      const float g = filtered[0][r] + l1 + b * filtered[2][r] + a * filtered[1][r];
      const bool hidden = in.meaning == MaskMeaning::kMask && !(u > 0);
      out.grad[3 * pixel + channel] = hidden ? 0.f : g;
    }
    __syncthreads();  // the next channel overwrites the planes
  }
}

}  // namespace

void RunPhotometric(const PhotometricInput& in, const PhotometricOutput& out, cudaStream_t stream) {
  const LaunchShape shape{PhotometricTiles(in.width, in.height), kSumThreads};
  for (int first = 0; first < 3; first += out.channels_at_once) {
    const Channels channels{first, first + out.channels_at_once};
    Launch("the SSIM's statistics", PhotometricStatistics, shape, stream, in, out, channels);
    if (out.grad != nullptr) Launch("the gradient of the image", PhotometricGradient, shape, stream, in, out, channels);
  }
}

}  // namespace oraclegs::cuda
