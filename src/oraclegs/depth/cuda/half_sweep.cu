// One thread a pixel. What a thread compares, one plane in one source at a time, needs no other thread: no barrier and
// no reduction, where a warp a pixel (41 samples on 32 lanes, a third of them idle) would add some twenty shuffles to
// each comparison. A warp has 32 neighbouring columns of two rows, in which the pixels of one colour alternate: once
// neighbours agree on planes, a warp's samples lie side by side in the source, and its windows overlap in the cache.
// Where pixels differ in how many planes are allowed, lanes wait for each other; that is the price.

#include "oraclegs/depth/cuda/half_sweep.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/depth/cuda/patch-inl.cuh"

namespace oraclegs::cuda {
namespace {

constexpr int kTileWidth = 32, kTileHeight = 8;         // pixels of a block, half of them of one colour
constexpr int kThreads = kTileWidth * kTileHeight / 2;  // few: each has long arrays, which the cache must hold

template <int kChannels>
__global__ void __launch_bounds__(kThreads) ImprovePixels(const __grid_constant__ HalfSweep sweep) {
  const int columns = (sweep.view.width + kTileWidth - 1) / kTileWidth;
  const int tile = static_cast<int>(blockIdx.x), thread = static_cast<int>(threadIdx.x);
  const int x = tile % columns * kTileWidth + thread % kTileWidth;
  const int y = tile / columns * kTileHeight + thread / kTileWidth * 2 + ((x + sweep.color) & 1);
  if (x >= sweep.view.width || y >= sweep.view.height || !sweep.view.TakesPart(x, y)) return;
  const DevicePatch<kChannels> patch(sweep, x, y);
  PixelSearch<DevicePatch<kChannels>>(sweep.view, x, y, patch).Improve(sweep.iteration);
}

}  // namespace

void RunHalfSweep(const HalfSweep& sweep, cudaStream_t stream) {
  const int64_t columns = (sweep.view.width + kTileWidth - 1) / kTileWidth;
  const LaunchShape shape{columns * ((sweep.view.height + kTileHeight - 1) / kTileHeight), kThreads};
  Launch("stereo's search", sweep.channels == 1 ? ImprovePixels<1> : ImprovePixels<3>, shape, stream, sweep);
}

}  // namespace oraclegs::cuda
