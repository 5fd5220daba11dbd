// A thread pool made for many short regions on a machine that others use too. A region is over when its tasks are done:
// it never waits for a helper that has not been given a core (an OpenMP barrier does, at several milliseconds a time on
// a busy laptop). Helpers spin for a moment between regions, then sleep.
//
// Each thread begins with its own chunk of the tasks, the same from region to region, and helps the others when that
// is done: what one region wrote is in the cache of the core whose thread reads it in the next, and threads rarely
// write to neighboring places at the same time.

#include "oraclegs/core/parallel.h"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace oraclegs {
namespace {

constexpr int kSpins = 2000;  // some tens of microseconds: about the serial work between two regions of an iteration

thread_local bool t_in_region = false;

void Pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb" ::: "memory");  // yield is nothing on most of these processors
#endif
}

/// Lives as long as the process: its threads do.
class Pool {
 public:
  /// For a process that was forked from that of `before`, whose threads it has not.
  explicit Pool(const Pool* before = nullptr) : before_(before) {}

  /// The pool that a fork has left behind: held, so that its memory does not seem lost.
  const Pool* before() const { return before_; }

  /// Returns false when another thread is running a region: the caller then works alone.
  bool Run(int64_t tasks, int threads, FunctionRef<void(int64_t)> body) {
    const std::unique_lock region(region_mutex_, std::try_to_lock);
    if (!region) return false;
    threads = WithWorkers(threads);
    if (threads < 2) return false;
    if (chunks_.size() < static_cast<size_t>(threads)) chunks_ = std::vector<Chunk>(threads);
    for (int worker_index = 0; worker_index < threads; ++worker_index) {
      chunks_[worker_index].next = tasks * worker_index / threads;
      chunks_[worker_index].end = tasks * (worker_index + 1) / threads;
    }
    body_ = &body;
    threads_ = threads;
    error_ = nullptr;
    failed_ = false;
    open_ = true;
    {
      const std::lock_guard lock(sleep_mutex_);
      ++generation_;
    }
    wake_.notify_all();
    TakeTasks(0);
    // A helper raises busy_ before it looks at open_, we close before we look at busy_: one of us sees the other.
    open_ = false;
    WaitForHelpers();
    if (error_) std::rethrow_exception(error_);
    return true;
  }

 private:
  /// Tasks that one thread begins with, on a cache line of their own.
  struct alignas(64) Chunk {
    std::atomic<int64_t> next{0};
    int64_t end = 0;
  };

  /// A helper that is about to finish is worth spinning for. One that has lost its core in the middle of a task gets it
  /// back sooner when ours is free.
  void WaitForHelpers() {
    for (int spin = 0; spin < kSpins; ++spin) {
      if (busy_ == 0) return;
      Pause();
    }
    for (int busy = busy_; busy != 0; busy = busy_) busy_.wait(busy);
  }

  /// Starts what lacks of `threads`; returns how many there are, fewer where the system gives no more.
  int WithWorkers(int threads) {
    try {
      for (; workers_ < threads - 1; ++workers_) {
        std::thread([this, worker_index = workers_ + 1] { Work(worker_index); }).detach();
      }
    } catch (const std::system_error&) {  // limits of threads or memory
    }
    return std::min(threads, workers_ + 1);
  }

  void TakeTasks(int worker_index) {
    t_in_region = true;
    for (int offset = 0; offset < threads_; ++offset) {
      Chunk& chunk = chunks_[(worker_index + offset) % threads_];
      for (int64_t i = chunk.next++; i < chunk.end; i = chunk.next++) RunTask(i);
    }
    t_in_region = false;
  }

  void RunTask(int64_t i) {
    if (failed_) return;
    try {
      (*body_)(i);
    } catch (...) {
      if (!failed_.exchange(true)) error_ = std::current_exception();
    }
  }

  [[noreturn]] void Work(int worker_index) {
    uint64_t seen = 0;
    while (true) {
      for (int spin = 0; spin < kSpins && generation_ == seen; ++spin) Pause();
      if (generation_ == seen) {
        std::unique_lock lock(sleep_mutex_);
        wake_.wait(lock, [&] { return generation_ != seen; });
      }
      seen = generation_;
      ++busy_;
      if (open_ && worker_index < threads_) TakeTasks(worker_index);
      if (--busy_ == 0) busy_.notify_one();
    }
  }

  const Pool* before_;
  std::mutex region_mutex_, sleep_mutex_;
  std::condition_variable wake_;
  std::atomic<uint64_t> generation_{0};
  std::atomic<bool> open_{false}, failed_{false};
  std::atomic<int> busy_{0};
  std::vector<Chunk> chunks_;
  int workers_ = 0;
  int threads_ = 0;  // of the region, the caller among them
  const FunctionRef<void(int64_t)>* body_ = nullptr;
  std::exception_ptr error_;
};

Pool& ThePool() {
  static std::atomic<Pool*> pool{new Pool};
  [[maybe_unused]] static const int at_fork = pthread_atfork(nullptr, nullptr, [] { pool = new Pool(pool); });
  return *pool;
}

std::atomic<int> g_threads{0};

}  // namespace

void SetNumThreads(int n) {
  g_threads = n > 0 ? n : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int NumThreads() {
  if (g_threads == 0) SetNumThreads(0);
  return g_threads;
}

void ParallelFor(int64_t tasks, FunctionRef<void(int64_t)> body) {
  const int threads = static_cast<int>(std::min<int64_t>(NumThreads(), tasks));
  if (threads > 1 && !t_in_region && ThePool().Run(tasks, threads, body)) return;
  for (int64_t i = 0; i < tasks; ++i) body(i);
}

void ParallelBlocks(int64_t n, int64_t grain, FunctionRef<void(int64_t, int64_t)> body) {
  ParallelFor((n + grain - 1) / grain, [&](int64_t block) { body(block * grain, std::min(n, (block + 1) * grain)); });
}

}  // namespace oraclegs
