#include "oraclegs/core/parallel.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

namespace oraclegs {
namespace {

int g_threads = 0;

}  // namespace

void SetNumThreads(int n) {
  g_threads = n > 0 ? n : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int NumThreads() {
  if (g_threads == 0) SetNumThreads(0);
  return g_threads;
}

void ParallelFor(int64_t tasks, const std::function<void(int64_t)>& body) {
  const int threads = static_cast<int>(std::min<int64_t>(NumThreads(), tasks));
  if (threads <= 1 || omp_in_parallel()) {
    for (int64_t i = 0; i < tasks; ++i) body(i);
    return;
  }
  std::exception_ptr error;
  std::atomic<bool> failed{false};
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (int64_t i = 0; i < tasks; ++i) {
    if (failed.load(std::memory_order_relaxed)) continue;
    try {
      body(i);
    } catch (...) {
      if (!failed.exchange(true)) error = std::current_exception();
    }
  }
  if (error) std::rethrow_exception(error);
}

void ParallelBlocks(int64_t n, int64_t grain, const std::function<void(int64_t, int64_t)>& body) {
  ParallelFor((n + grain - 1) / grain, [&](int64_t block) { body(block * grain, std::min(n, (block + 1) * grain)); });
}

}  // namespace oraclegs
