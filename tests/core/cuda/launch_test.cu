// Launches, and what kernels may rely on: blocks, barriers, warps.

#include "oraclegs/core/cuda/launch.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

#include "support/cuda_device.h"

namespace oraclegs::cuda {
namespace {

class LaunchTest : public CudaTest {};

__global__ void WriteIndex(int* out, int n) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) out[i] = i;
}

/// Sum of a block's items by shuffles, then over its warps through shared memory.
__global__ void SumBlocks(const int* in, int* out) {
  __shared__ int warp_sums[8];
  int sum = in[blockIdx.x * blockDim.x + threadIdx.x];
  for (int step = 16; step > 0; step /= 2) sum += __shfl_down_sync(kAllLanes, sum, step);
  if (threadIdx.x % 32 == 0) warp_sums[threadIdx.x / 32] = sum;
  __syncthreads();
  if (threadIdx.x != 0) return;
  int total = 0;
  for (unsigned w = 0; w < blockDim.x / 32; ++w) total += warp_sums[w];
  out[blockIdx.x] = total;
}

__global__ void WarpOperations(unsigned* out) {
  const unsigned lane = threadIdx.x % 32;
  unsigned* mine = out + 6 * threadIdx.x;
  mine[0] = __ballot_sync(kAllLanes, lane % 3 == 0);
  mine[1] = __shfl_up_sync(kAllLanes, lane, 1);
  mine[2] = __shfl_xor_sync(kAllLanes, lane, 5);
  mine[3] = __shfl_sync(kAllLanes, lane, 7);
  mine[4] = static_cast<unsigned>(__syncthreads_count(lane < 4));
  mine[5] = 0;
  if (lane < 16) mine[5] = __shfl_xor_sync(0xffffu, lane, 15);  // half of the warp
}

TEST_F(LaunchTest, RunsEveryThreadOnce) {
  DeviceArray<int> out("out");
  out.Reserve(1000);
  Launch("WriteIndex", WriteIndex, LaunchShape::For(1000, 128), nullptr, out.data(), 1000);
  std::vector<int> expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(ToHost(out, 1000), expected);
}

TEST_F(LaunchTest, NoBlocksAreNoLaunch) {
  EXPECT_NO_THROW(Launch("WriteIndex", WriteIndex, LaunchShape::For(0), nullptr, nullptr, 0));
}

TEST_F(LaunchTest, BarriersAndShufflesOrderABlock) {
  std::vector<int> values(3 * 256);
  std::iota(values.begin(), values.end(), 0);
  DeviceArray<int> in("in"), out("out");
  in.Upload(values.data(), 3 * 256);
  out.Reserve(3);
  Launch("SumBlocks", SumBlocks, {3, 256}, nullptr, in.data(), out.data());
  EXPECT_EQ(ToHost(out, 3), (std::vector<int>{32640, 98176, 163712}));
}

TEST_F(LaunchTest, WarpOperationsSeeTheirLanes) {
  DeviceArray<unsigned> out("out");
  out.Reserve(6 * 64);
  Launch("WarpOperations", WarpOperations, {1, 64}, nullptr, out.data());
  const std::vector<unsigned> values = ToHost(out, 6 * 64);
  for (unsigned i = 0; i < 64; ++i) {
    const unsigned lane = i % 32;
    EXPECT_EQ(values[6 * i], 0x49249249u);
    EXPECT_EQ(values[6 * i + 1], lane == 0 ? 0 : lane - 1);
    EXPECT_EQ(values[6 * i + 2], lane ^ 5);
    EXPECT_EQ(values[6 * i + 3], 7u);
    EXPECT_EQ(values[6 * i + 4], 8u);
    EXPECT_EQ(values[6 * i + 5], lane < 16 ? 15 - lane : 0u);
  }
}

#if defined(ORACLEGS_EMULATED_CUDA)
__global__ void MissesABarrier() {
  if (threadIdx.x == 3) return;
  __syncthreads();
}
__global__ void NamesALaneThatLeft() {
  if (threadIdx.x == 3) return;
  __shfl_sync(kAllLanes, 1, 0);
}
__global__ void LeavesItselfOut() { __ballot_sync(2u, 1); }
__global__ void Disagrees() {
  if (threadIdx.x % 2 == 0) {
    __ballot_sync(kAllLanes, 1);
  } else {
    __shfl_sync(kAllLanes, 1, 0);
  }
}

TEST_F(LaunchTest, WhatHardwareLeavesUndefinedIsRefused) {
  for (void (*kernel)() : {MissesABarrier, NamesALaneThatLeft, LeavesItselfOut, Disagrees}) {
    EXPECT_THROW(Launch("wrong", kernel, {1, 32}, nullptr), std::logic_error);
  }
  DeviceArray<int> out("out");  // and the next launch is none the worse
  out.Reserve(3);
  EXPECT_NO_THROW(Launch("WriteIndex", WriteIndex, {1, 32}, nullptr, out.data(), 3));
}
#endif

}  // namespace
}  // namespace oraclegs::cuda
