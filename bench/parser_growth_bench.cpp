// How time and memory of every parser grow with its input, from 10 kB to 10 MB:
//   parser_growth_bench [WORD]   only the rows that contain WORD
// Prints a row for each kind of input: processor seconds and peak of the heap, beyond the input itself, at the largest
// size; and the exponents of both (the slope between sizes in a diagram of logarithms), from all sizes and from the
// last three, where what grows has outgrown all constants. Fails where time grows faster than with the power 1.1, or
// memory than with 1.0, by more than caches and packing explain.

#include <malloc.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <span>

#include "bench/parser_inputs.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/parallel.h"

namespace {

std::atomic<int64_t> g_live{0}, g_peak{0};

void* Taken(void* memory) {
  if (memory != nullptr) {
    const int64_t live = g_live += static_cast<int64_t>(malloc_usable_size(memory));
    int64_t peak = g_peak;
    while (live > peak && !g_peak.compare_exchange_weak(peak, live)) {
    }
  }
  return memory;
}

void Given(void* memory) {
  if (memory != nullptr) g_live -= static_cast<int64_t>(malloc_usable_size(memory));
}

}  // namespace

// The heap of this program counts: operator new, zlib, libzip, libwebp and all others take from it.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);

void* malloc(size_t size) noexcept { return Taken(__libc_malloc(size)); }
void* calloc(size_t count, size_t size) noexcept { return Taken(__libc_calloc(count, size)); }
void* realloc(void* old, size_t size) noexcept {
  Given(old);
  return Taken(__libc_realloc(old, size));
}
void* memalign(size_t alignment, size_t size) noexcept { return Taken(__libc_memalign(alignment, size)); }
void* aligned_alloc(size_t alignment, size_t size) noexcept { return Taken(__libc_memalign(alignment, size)); }
int posix_memalign(void** out, size_t alignment, size_t size) noexcept {
  *out = Taken(__libc_memalign(alignment, size));
  return *out == nullptr ? 12 : 0;  // ENOMEM
}
void free(void* memory) noexcept {
  Given(memory);
  __libc_free(memory);
}
}

namespace oraclegs {
namespace {

// A step is four times the one before: a table or vector that doubles is as full at each.
constexpr double kSizes[] = {1e4, 4e4, 1.6e5, 6.4e5, 2.56e6, 1.024e7};  // bytes
constexpr size_t kLast = 3;                                             // so many sizes show the growth at the end
constexpr double kLeastStep = 3;  // a shorter one, to the most that a parser takes, would show how full tables are
constexpr double kLeastSeconds = 1e-5, kLeastPeak = 2048,
                 kLeastBytes = 1000;  // less is not measured: the clock, rounding
constexpr double kMostSeconds = 20;   // a larger input is not tried then
constexpr double kMostTimeExponent = 1.1, kMostMemoryExponent = 1.0;
constexpr double kPacking = 0.025;  // the last sizes of SPZ pack better than the others
// Tables of large inputs outgrow the caches, and then each step waits longer for memory: with 20 000 names of views the
// exponent is 1.13 to 1.17 (1.2 to 1.29 at the end), though instructions grow with 1.0. Whatever is quadratic reaches
// 1.5 at the end.
constexpr double kCaches = 0.1, kCachesAtEnd = 0.25;
constexpr int kRounds = 5;  // through all sizes: a slow spell of the machine meets each

struct GrowthPoint {
  std::string file;
  double bytes = 0;  ///< beyond those of the smallest file
  double seconds = INFINITY, peak = 0;
};

/// Seconds of this program, from which others take none.
double ProcessorSeconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Takes the caches from the next input, a small one, too: else only large ones would wait for memory.
void EmptyCaches() {
  static std::vector<uint64_t> other(8 << 20 >> 3);
  for (uint64_t& x : other) ++x;
}

void MeasureParser(const ParserInput& input, GrowthPoint* point) {
  if (!input.placed.empty()) ReplaceFile(BenchFolder() / input.placed, point->file);
  EmptyCaches();
  const int64_t before = g_live;
  g_peak = before;
  const double start = ProcessorSeconds();
  try {
    input.read(point->file);
  } catch (const Error&) {
  }
  point->seconds = std::min(point->seconds, ProcessorSeconds() - start);
  point->peak = static_cast<double>(g_peak - before);
}

/// Slope of the logarithms by least squares of what some inputs took; NaN where fewer than two took more than `least`:
/// it does not grow.
double ExponentOf(std::span<const GrowthPoint> points, double GrowthPoint::*value, double least) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const GrowthPoint& p : points) {
    if (!(p.*value > least) || p.bytes < kLeastBytes) continue;
    const double u = std::log(p.bytes), v = std::log(p.*value);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  return n < 2 ? NAN : (n * xy - x * y) / (n * xx - x * x);
}

/// Prints the row of one kind of input; false where it grows too fast.
bool ShowGrowth(const ParserInput& input) {
  std::vector<GrowthPoint> points;
  const auto header = static_cast<double>(input.make(1).size());  // which would make small files too large
  for (const double bytes : kSizes) {
    points.push_back({input.make(static_cast<size_t>(bytes))});
    points.back().bytes = static_cast<double>(points.back().file.size()) - header;
  }
  while (points.size() > kLast && points.back().bytes < kLeastStep * points[points.size() - 2].bytes) points.pop_back();
  for (int round = 0; round < kRounds; ++round) {
    for (size_t i = 0; i < points.size(); ++i) {
      MeasureParser(input, &points[i]);
      if (points[i].seconds > kMostSeconds) points.resize(i + 1);
    }
  }
  const std::span<const GrowthPoint> all(points), end = all.last(std::min(kLast, all.size()));
  const auto time = [&](auto some) { return ExponentOf(some, &GrowthPoint::seconds, kLeastSeconds); };
  const auto heap = [&](auto some) { return ExponentOf(some, &GrowthPoint::peak, kLeastPeak); };
  const double values[] = {time(all), time(end), heap(all), heap(end)};
  const bool fails = values[0] > kMostTimeExponent + kCaches || values[1] > kMostTimeExponent + kCachesAtEnd ||
                     values[3] > kMostMemoryExponent + kPacking;
  const GrowthPoint& last = points.back();
  std::printf("%-16s %-34s %10.0f %10.5f %12.0f", input.parser.c_str(), input.input.c_str(),
              static_cast<double>(last.file.size()), last.seconds, last.peak);
  for (const double value : values) std::printf(std::isnan(value) ? "     -" : " %5.2f", value);
  std::printf("%s\n", fails ? "  GROWS TOO FAST" : "");
  std::fflush(stdout);
  return !fails;
}

int RunGrowth(const char* word) {
  SetNumThreads(1);
  // The heap keeps its pages: large inputs would pay for new ones in every repeat, small ones never.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  std::printf("%-16s %-34s %10s %10s %12s %5s %5s %5s %5s\n", "parser", "input", "bytes", "seconds", "heap bytes",
              "time", "end", "heap", "end");
  int failures = 0;
  for (const auto& inputs :
       {SplatInputs(), SceneInputs(), DatasetInputs(), PhotoInputs(), WeightInputs(), RunInputs()}) {
    for (const ParserInput& input : inputs) {
      if ((input.parser + " " + input.input).find(word) == std::string::npos) continue;
      failures += ShowGrowth(input) ? 0 : 1;
    }
  }
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) { return oraclegs::RunGrowth(argc > 1 ? argv[1] : ""); }
