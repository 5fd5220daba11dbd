#pragma once
// A grid of threads on the host. Blocks run one after another, in any order; the threads of a block are fibers of their
// own stacks, which take turns, in any order, whenever one waits: for its block (__syncthreads) or for lanes of its
// warp (shuffles, votes). Shared memory is spoiled before each block. What hardware leaves undefined is refused here
// with a std::logic_error: a barrier that a thread of the block does not reach, a shuffle whose mask names a lane that
// does not take part.

#include <cuda_runtime.h>

#include <cstdint>
#include <functional>

/// Position of the running thread; a copy of the runtime's own names.
extern uint3 threadIdx, blockIdx;
extern dim3 blockDim, gridDim;
inline constexpr int warpSize = 32;

namespace emulated_cuda {

/// Runs thread() once for each thread of the grid.
void RunGrid(const char* kernel, dim3 grid, dim3 block, const std::function<void()>& thread);

/// Waits for all threads of the block. Returns the sum of all their `value`.
int64_t SyncBlock(int64_t value);

/// Which warp operation a lane takes part in: all of a mask must agree.
enum class WarpOp { kSync, kShuffle, kVote };

/// Waits for all lanes of `mask`, each bringing a value. Returns 32 values, of which those of the mask are set; they
/// are valid until the thread waits again.
const uint64_t* SyncWarp(unsigned mask, WarpOp op, uint64_t value);

/// Lane of the running thread in its warp.
int Lane();

}  // namespace emulated_cuda
