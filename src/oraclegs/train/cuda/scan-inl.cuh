#pragma once
// Running sums of integers: within blocks, over the blocks' totals, then both added. Three launches, once in a hundred
// iterations. With integers no order of addition changes a bit, and a sum never falls.

#include <cstdint>

#include "oraclegs/core/cuda/launch.h"

namespace oraclegs::cuda {

inline constexpr int kScanBlock = 256;

inline int64_t ScanBlocks(int64_t count) { return (count + kScanBlock - 1) / kScanBlock; }

/// Replaces `values` by their inclusive running sums.
struct ScanInput {
  uint64_t* values = nullptr;  ///< [count], the device's
  int64_t count = 0;
  uint64_t* totals = nullptr;  ///< [ScanBlocks(count)] scratch
};

/// The running sum over a block of kScanBlock threads; `shared` has kScanBlock entries.
__device__ inline uint64_t BlockScan(uint64_t value, int thread, uint64_t* shared) {
  shared[thread] = value;
  __syncthreads();
  for (int reach = 1; reach < kScanBlock; reach *= 2) {
    const uint64_t before = thread >= reach ? shared[thread - reach] : 0;
    __syncthreads();
    shared[thread] += before;
    __syncthreads();
  }
  const uint64_t sum = shared[thread];
  __syncthreads();
  return sum;
}

__global__ void ScanWithinBlocks(ScanInput in) {
  __shared__ uint64_t shared[kScanBlock];
  const int thread = static_cast<int>(threadIdx.x);
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kScanBlock + thread;
  const uint64_t sum = BlockScan(i < in.count ? in.values[i] : 0, thread, shared);
  if (i < in.count) in.values[i] = sum;
  if (thread == kScanBlock - 1) in.totals[blockIdx.x] = sum;
}

/// Scans the blocks' totals, in one block.
__global__ void ScanTotals(ScanInput in, int64_t blocks) {
  __shared__ uint64_t shared[kScanBlock];
  __shared__ uint64_t carried;
  const int thread = static_cast<int>(threadIdx.x);
  if (thread == 0) carried = 0;
  __syncthreads();
  for (int64_t begin = 0; begin < blocks; begin += kScanBlock) {
    const int64_t i = begin + thread;
    const uint64_t sum = carried + BlockScan(i < blocks ? in.totals[i] : 0, thread, shared);
    if (i < blocks) in.totals[i] = sum;
    __syncthreads();
    if (thread == kScanBlock - 1) carried = sum;
    __syncthreads();
  }
}

__global__ void AddTotals(ScanInput in) {
  const int64_t i = (static_cast<int64_t>(blockIdx.x) + 1) * kScanBlock + threadIdx.x;
  if (i < in.count) in.values[i] += in.totals[blockIdx.x];
}

inline void LaunchScan(const ScanInput& in, cudaStream_t stream) {
  const int64_t blocks = ScanBlocks(in.count);
  Launch("scan", ScanWithinBlocks, {blocks, kScanBlock}, stream, in);
  if (blocks < 2) return;
  Launch("scan of totals", ScanTotals, {1, kScanBlock}, stream, in, blocks);
  Launch("scan, last pass", AddTotals, {blocks - 1, kScanBlock}, stream, in);
}

}  // namespace oraclegs::cuda
