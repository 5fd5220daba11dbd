// How time and memory of every parser grow with its input, from 10 kB to 10 MB:
//   parser_growth_bench [WORD]   only the rows that contain WORD
// Prints a row for each kind of input: processor seconds and peak of the heap at the largest size, the exponents of
// both (the slope between sizes in a diagram of logarithms), and fails where time grows faster than with the power 1.1,
// memory than 1.0.

#include <malloc.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>

#include "bench/parser_inputs.h"
#include "oraclegs/core/error.h"
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

constexpr double kSizes[] = {1e4, 3e4, 1e5, 3e5, 1e6, 3e6, 1e7};  // bytes
constexpr double kLeastSeconds = 5e-3, kLeastPeak = 1 << 18;      // below, constants are larger than what grows
constexpr double kMostSeconds = 20;                               // a larger input is not tried then
constexpr double kMostTimeExponent = 1.1, kMostMemoryExponent = 1.0, kNoise = 0.1;  // caches, doubling
constexpr int kRepeats = 5;

struct GrowthPoint {
  double bytes, seconds, peak;
};

/// Processor seconds of this process alone, independent of other load.
double ProcessorSeconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

GrowthPoint MeasureParser(const ParserInput& input, double bytes) {
  const std::string file = input.make(static_cast<size_t>(bytes));
  GrowthPoint point{static_cast<double>(file.size()), INFINITY, 0};
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const int64_t before = g_live;
    g_peak = before;
    const double start = ProcessorSeconds();
    try {
      input.read(file);
    } catch (const Error&) {
    }
    const double passed = ProcessorSeconds() - start;
    point.seconds = std::min(point.seconds, passed);
    point.peak = static_cast<double>(g_peak - before);
    if (passed > 2) break;
  }
  return point;
}

/// Least-squares slope of the logarithms, over the points above the constant costs; NaN with fewer than two.
double ExponentOf(const std::vector<GrowthPoint>& points, double GrowthPoint::*value, double least) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const GrowthPoint& p : points) {
    if (p.*value < least) continue;
    const double u = std::log(p.bytes), v = std::log(p.*value);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  return n < 2 ? NAN : (n * xy - x * y) / (n * xx - x * x);
}

int RunGrowth(const char* word) {
  SetNumThreads(1);
  // The heap keeps its pages: large inputs would pay for new ones in every repeat, small ones never.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  std::printf("%-16s %-34s %10s %10s %12s %6s %6s\n", "parser", "input", "bytes", "seconds", "heap bytes", "time",
              "heap");
  int failures = 0;
  for (const auto& inputs : {SplatInputs(), SceneInputs(), OtherInputs()}) {
    for (const ParserInput& input : inputs) {
      if ((input.parser + " " + input.input).find(word) == std::string::npos) continue;
      std::vector<GrowthPoint> points;
      for (const double bytes : kSizes) {
        points.push_back(MeasureParser(input, bytes));
        if (points.back().seconds > kMostSeconds) break;
      }
      const double time = ExponentOf(points, &GrowthPoint::seconds, kLeastSeconds);
      const double heap = ExponentOf(points, &GrowthPoint::peak, kLeastPeak);
      const bool fails = time > kMostTimeExponent + kNoise || heap > kMostMemoryExponent + kNoise;
      const GrowthPoint& last = points.back();
      std::printf("%-16s %-34s %10.0f %10.4f %12.0f %6.2f %6.2f%s\n", input.parser.c_str(), input.input.c_str(),
                  last.bytes, last.seconds, last.peak, time, heap, fails ? "  GROWS TOO FAST" : "");
      std::fflush(stdout);
      failures += fails ? 1 : 0;
    }
  }
  return failures == 0 ? 0 : 1;
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) { return oraclegs::RunGrowth(argc > 1 ? argv[1] : ""); }
