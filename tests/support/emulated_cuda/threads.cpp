#include "support/emulated_cuda/threads.h"

#include <setjmp.h>
#include <ucontext.h>

#include <cstring>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/emulated_cuda/stack_switch.h"

uint3 threadIdx, blockIdx;
dim3 blockDim, gridDim;

namespace emulated_cuda {
namespace {

constexpr size_t kStackBytes = size_t{1} << 17;

/// One operation of a warp that its lanes meet for.
struct Exchange {
  unsigned mask = 0, arrived = 0, reading = 0;  // reading: complete, and these lanes have not gone on yet
  WarpOp op = WarpOp::kSync;
  uint64_t values[32];
};

struct Fiber {
  enum class State { kReady, kAtBarrier, kInExchange, kDone };
  std::unique_ptr<char[]> stack{new char[kStackBytes]};
  uint3 index{};
  State state = State::kReady;
  bool started = false;
  const Exchange* exchange = nullptr;
  ucontext_t first{};  // makecontext's; later turns are by longjmp, which makes no system call
  jmp_buf turn;
  StackOfOthers returns_to;  // while it runs: the scheduler's stack
};

/// Four: an exchange that is being read, the next one, and room for a second group of lanes.
struct Warp {
  Exchange exchanges[4];
};

struct Block {
  std::vector<std::unique_ptr<Fiber>> fibers;  // kept from launch to launch
  std::vector<Warp> warps;
  const std::function<void()>* thread = nullptr;
  Fiber* running = nullptr;
  int64_t barrier_sum = 0, barrier_result = 0;
  std::string failure;
  jmp_buf scheduler;
};

Block block;  // one kernel runs at a time

void Yield() {
  Fiber* const fiber = block.running;
  StackSwitch to_scheduler(&fiber->returns_to);
  if (_setjmp(fiber->turn) == 0) {
    to_scheduler.Leave();
    _longjmp(block.scheduler, 1);
  }
  to_scheduler.ComeBack();
}

/// The end of the running fiber.
[[noreturn]] void LeaveForGood() {
  block.running->state = Fiber::State::kDone;
  StackSwitch::LeaveForGood(block.running->returns_to);
  _longjmp(block.scheduler, 1);
}

/// Ends the running fiber; the scheduler throws.
[[noreturn]] void Fail(const char* what) {  // no string: nothing is destroyed on the way out
  block.failure = what;
  LeaveForGood();
}

void RunFiber() {
  StackSwitch::Arrive(&block.running->returns_to);
  (*block.thread)();
  LeaveForGood();
}

void Resume(Fiber* fiber) {
  block.running = fiber;
  threadIdx = fiber->index;
  fiber->state = Fiber::State::kReady;
  StackOfOthers stack{fiber->stack.get(), kStackBytes};
  StackSwitch to_fiber(&stack);
  if (_setjmp(block.scheduler) != 0) {
    to_fiber.ComeBack();
    return;
  }
  to_fiber.Leave();
  if (fiber->started) _longjmp(fiber->turn, 1);
  fiber->started = true;
  ForgetFrames(fiber->stack.get(), kStackBytes);
  getcontext(&fiber->first);
  fiber->first.uc_stack.ss_sp = fiber->stack.get();
  fiber->first.uc_stack.ss_size = kStackBytes;
  fiber->first.uc_link = nullptr;
  makecontext(&fiber->first, RunFiber, 0);
  setcontext(&fiber->first);
}

bool CanGoOn(const Fiber& fiber) {
  if (fiber.state == Fiber::State::kInExchange) return fiber.exchange->reading != 0;
  return fiber.state == Fiber::State::kReady;
}

/// A random order of 0 .. count-1, which a device could take, too; different each time.
class AnyOrder {
 public:
  explicit AnyOrder(size_t count) : count_(count), first_(Draw() % count), step_(Draw() % count) {
    while (std::gcd(step_, count_) != 1) step_ = (step_ + 1) % count_;
  }
  size_t operator[](size_t i) const { return (first_ + i * step_) % count_; }

 private:
  static size_t Draw() {
    static uint64_t state = 1;  // the same from run to run
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<size_t>(state >> 33);
  }

  size_t count_, first_, step_;
};

/// Fills shared memory with leftovers, as a device has them.
void SpoilSharedMemory() {
#if defined(ORACLEGS_SHARED_SECTION)
  std::memset(__start_emulated_shared, 0xff, static_cast<size_t>(__stop_emulated_shared - __start_emulated_shared));
#endif
}

/// Resumes the threads of one warp until all of them wait for others. Returns whether any could go on.
bool RunWarp(size_t begin, size_t end) {
  bool any = false;
  const AnyOrder lanes(end - begin);
  for (bool progress = true; progress;) {
    progress = false;
    for (size_t lane = 0; lane < end - begin; ++lane) {
      const size_t i = begin + lanes[lane];
      if (!CanGoOn(*block.fibers[i])) continue;
      Resume(block.fibers[i].get());
      if (!block.failure.empty()) return true;
      progress = any = true;
    }
  }
  return any;
}

/// Opens the barrier at which all threads wait, when no thread can go on; returns false at the end. Throws for any
/// other cause.
bool OpenBarrier(size_t threads) {
  size_t done = 0, waiting = 0;
  for (size_t i = 0; i < threads; ++i) {
    done += block.fibers[i]->state == Fiber::State::kDone;
    waiting += block.fibers[i]->state == Fiber::State::kAtBarrier;
  }
  if (done == threads) return false;
  if (waiting != threads) {
    throw std::logic_error("of " + std::to_string(threads) + " threads " + std::to_string(waiting) +
                           " wait at a barrier, " + std::to_string(done) + " have ended and " +
                           std::to_string(threads - waiting - done) + " wait for lanes that do not come");
  }
  for (size_t i = 0; i < threads; ++i) block.fibers[i]->state = Fiber::State::kReady;
  block.barrier_result = block.barrier_sum;
  block.barrier_sum = 0;
  return true;
}

void RunBlock(size_t threads) {
  block.warps.assign((threads + 31) / 32, Warp());
  block.barrier_sum = 0;
  block.failure.clear();
  while (block.fibers.size() < threads) block.fibers.push_back(std::make_unique<Fiber>());
  for (size_t i = 0; i < threads; ++i) {
    Fiber& fiber = *block.fibers[i];
    fiber.index = {static_cast<unsigned>(i % blockDim.x), static_cast<unsigned>(i / blockDim.x % blockDim.y),
                   static_cast<unsigned>(i / blockDim.x / blockDim.y)};
    fiber.state = Fiber::State::kReady;
    fiber.started = false;
  }
  SpoilSharedMemory();
  const AnyOrder warps(block.warps.size());
  do {
    for (bool progress = true; progress;) {
      progress = false;
      for (size_t warp = 0; warp < block.warps.size(); ++warp) {
        const size_t begin = 32 * warps[warp];
        progress |= RunWarp(begin, std::min(begin + 32, threads));
        if (!block.failure.empty()) throw std::logic_error(block.failure);
      }
    }
  } while (OpenBarrier(threads));
}

size_t ThreadInBlock() { return threadIdx.x + blockDim.x * (threadIdx.y + size_t{blockDim.y} * threadIdx.z); }

Exchange* Join(Warp* warp, unsigned mask, WarpOp op, unsigned self) {
  for (Exchange& e : warp->exchanges) {
    if (e.arrived == 0 || (e.mask & mask) == 0) continue;
    if (e.mask != mask || e.op != op || (e.arrived & self) != 0) {
      Fail("lanes of one mask are in different warp operations, or name different masks");
    }
    return &e;
  }
  for (Exchange& e : warp->exchanges) {
    if (e.reading != 0 || e.arrived != 0) continue;
    e.mask = mask;
    e.op = op;
    return &e;
  }
  Fail("a warp is in more than four operations at once");
}

}  // namespace

void RunGrid(const char* kernel, dim3 grid, dim3 threads, const std::function<void()>& thread) {
  gridDim = grid;
  blockDim = threads;
  block.thread = &thread;
  try {
    const size_t blocks = size_t{grid.x} * grid.y * grid.z;
    if (blocks == 0) return;
    const AnyOrder order(blocks);
    for (size_t i = 0; i < blocks; ++i) {
      const size_t b = order[i];
      blockIdx = {static_cast<unsigned>(b % grid.x), static_cast<unsigned>(b / grid.x % grid.y),
                  static_cast<unsigned>(b / grid.x / grid.y)};
      RunBlock(size_t{threads.x} * threads.y * threads.z);
    }
  } catch (const std::logic_error& error) {
    throw std::logic_error(std::string(kernel) + ": " + error.what());
  }
}

int64_t SyncBlock(int64_t value) {
  block.barrier_sum += value;
  block.running->state = Fiber::State::kAtBarrier;
  Yield();
  return block.barrier_result;
}

int Lane() { return static_cast<int>(ThreadInBlock() % 32); }

const uint64_t* SyncWarp(unsigned mask, WarpOp op, uint64_t value) {
  const unsigned self = 1u << Lane();
  if (!(mask & self)) Fail("the mask of a warp operation leaves out a lane that takes part");
  Exchange* exchange = Join(&block.warps[ThreadInBlock() / 32], mask, op, self);
  exchange->values[Lane()] = value;
  exchange->arrived |= self;
  if (exchange->arrived != mask) {
    block.running->exchange = exchange;
    block.running->state = Fiber::State::kInExchange;
    Yield();
  } else {
    exchange->reading = mask;
    exchange->arrived = 0;
  }
  exchange->reading &= ~self;
  return exchange->values;
}

}  // namespace emulated_cuda
