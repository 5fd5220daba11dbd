// The two loops that bound every stage. Registers only: kChains independent fused multiply-adds, more than latency
// times ports of any core. Memory only: a copy with stores that bypass the caches, or without, whichever is faster.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/ceilings.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// More than two ports times four cycles of latency; sixteen registers leave room for two constants.
constexpr int kChains = 12;

/// Runs the loop and returns its flops. The chains begin at x[0 .. kChains - 1], all different, so that the compiler
/// cannot merge them; x[0] receives a result, so that it cannot drop them.
double FmaLoop(int64_t rounds, float* x) {
  const hn::CappedTag<float, 16> d;
  const auto half = hn::Set(d, 0.5f), one = hn::Set(d, 1.f);  // x -> x / 2 + 1 tends to 2: never denormal
  auto a = hn::Set(d, x[0]), b = hn::Set(d, x[1]), c = hn::Set(d, x[2]), e = hn::Set(d, x[3]), f = hn::Set(d, x[4]),
       g = hn::Set(d, x[5]), h = hn::Set(d, x[6]), i = hn::Set(d, x[7]), j = hn::Set(d, x[8]), k = hn::Set(d, x[9]),
       l = hn::Set(d, x[10]), m = hn::Set(d, x[11]);
  for (int64_t round = 0; round < rounds; ++round) {
    a = hn::MulAdd(a, half, one), b = hn::MulAdd(b, half, one), c = hn::MulAdd(c, half, one);
    e = hn::MulAdd(e, half, one), f = hn::MulAdd(f, half, one), g = hn::MulAdd(g, half, one);
    h = hn::MulAdd(h, half, one), i = hn::MulAdd(i, half, one), j = hn::MulAdd(j, half, one);
    k = hn::MulAdd(k, half, one), l = hn::MulAdd(l, half, one), m = hn::MulAdd(m, half, one);
  }
  for (const auto& chain : {b, c, e, f, g, h, i, j, k, l, m}) a = hn::Add(a, chain);
  x[0] = hn::GetLane(a);
  return 2.0 * kChains * static_cast<double>(hn::Lanes(d)) * static_cast<double>(rounds);
}

void StreamCopy(const float* HWY_RESTRICT from, float* HWY_RESTRICT to, int64_t count) {
  const hn::CappedTag<float, 16> d;
  for (int64_t i = 0; i < count; i += static_cast<int64_t>(hn::Lanes(d))) hn::Stream(hn::Load(d, from + i), d, to + i);
  hwy::FlushStream();
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <hwy/aligned_allocator.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <numeric>
#include <vector>

#include "bench/ceilings.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
HWY_EXPORT(FmaLoop);
HWY_EXPORT(StreamCopy);
HWY_EXPORT(TargetName);

namespace {

constexpr int kFmaRuns = 9, kCopyRuns = 3;
constexpr int kFmaStarts = 16;            // at least kChains
constexpr int64_t kTasks = 64;            // more than threads, so that a thread that starts late costs little
constexpr int64_t kFmaRounds = 1 << 16;   // of a task: about 0.1 ms
constexpr int64_t kCopyGrain = 1 << 18;   // floats of a task: 1 MiB
constexpr int64_t kMinArray = 256 << 20;  // bytes

template <class F>
double SecondsOf(const F& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double FlopsPerSecond() {
  std::vector<double> rates;
  for (int run = 0; run < kFmaRuns; ++run) {
    std::vector<double> flops(kTasks);
    std::vector<std::array<float, kFmaStarts>> starts(kTasks);
    for (auto& start : starts) std::iota(start.begin(), start.end(), 1.f);
    const double seconds = SecondsOf([&] {
      ParallelFor(kTasks, [&](int64_t t) { flops[t] = HWY_DYNAMIC_DISPATCH(FmaLoop)(kFmaRounds, starts[t].data()); });
    });
    double sum = 0;
    for (const double f : flops) sum += f;
    rates.push_back(sum / seconds);
  }
  return UpperMedian(rates);
}

double BytesPerSecond() {
  static const int64_t count = CopyArrayBytes() / static_cast<int64_t>(sizeof(float));
  static const auto make = [] {
    auto array = hwy::AllocateAligned<float>(count);
    ParallelBlocks(count, kCopyGrain,
                   [&](int64_t begin, int64_t end) { std::fill_n(&array[begin], end - begin, 1.f); });
    return array;
  };
  static const auto from = make(), to = make();
  const auto rate = [&](auto&& copy) {
    std::vector<double> rates;
    for (int run = 0; run < kCopyRuns; ++run) {
      const double seconds = SecondsOf([&] {
        ParallelBlocks(count, kCopyGrain,
                       [&](int64_t begin, int64_t end) { copy(&from[begin], &to[begin], end - begin); });
      });
      rates.push_back(2 * sizeof(float) * static_cast<double>(count) / seconds);
    }
    return UpperMedian(rates);
  };
  return std::max(rate([](const float* a, float* b, int64_t n) {
                    HWY_DYNAMIC_DISPATCH(StreamCopy)
                    (a, b, n);
                  }),
                  rate([](const float* a, float* b, int64_t n) { std::memcpy(b, a, n * sizeof(float)); }));
}

}  // namespace

Ceilings MeasureCeilings() { return {FlopsPerSecond(), BytesPerSecond()}; }

Ceilings Between(const Ceilings& before, const Ceilings& after) {
  return {(before.flops + after.flops) / 2, (before.bytes + after.bytes) / 2};
}

std::string SimdTarget() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

int64_t LastLevelCacheBytes() {
#if defined(_SC_LEVEL3_CACHE_SIZE)
  return std::max<int64_t>({0, sysconf(_SC_LEVEL3_CACHE_SIZE), sysconf(_SC_LEVEL2_CACHE_SIZE)});
#else
  return 0;
#endif
}

int64_t CopyArrayBytes() {
  const int64_t wanted = std::max(kMinArray, 2 * LastLevelCacheBytes());
  const int64_t block = kCopyGrain * static_cast<int64_t>(sizeof(float));
  return (wanted + block - 1) / block * block;
}

}  // namespace oraclegs
#endif
