#include "support/allocations.h"

#include <atomic>
#include <cstdlib>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define ORACLEGS_FOREIGN_MALLOC 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ORACLEGS_FOREIGN_MALLOC 1
#endif

#if defined(__GLIBC__) && !defined(ORACLEGS_FOREIGN_MALLOC)
#define ORACLEGS_COUNTS_ALLOCATIONS 1
#include <execinfo.h>

#include <cerrno>
#else
#define ORACLEGS_COUNTS_ALLOCATIONS 0
#endif

namespace oraclegs {

bool AllocationCounter::Works() { return ORACLEGS_COUNTS_ALLOCATIONS; }

#if ORACLEGS_COUNTS_ALLOCATIONS

namespace {

constexpr int kMaxFrames = 24;

std::atomic<bool> g_counting{false};
std::atomic<int64_t> g_count{0}, g_bytes{0};
void* g_frames[kMaxFrames];
int g_num_frames = 0;

void Count(size_t bytes) {
  if (!g_counting.load(std::memory_order_relaxed)) return;
  g_bytes += static_cast<int64_t>(bytes);
  if (g_count++ == 0) g_num_frames = backtrace(g_frames, kMaxFrames);
}

}  // namespace

void AllocationCounter::Begin() {
  void* frame;
  backtrace(&frame, 1);  // the first call allocates
  g_count = 0;
  g_bytes = 0;
  g_num_frames = 0;
  g_counting = true;
}

int64_t AllocationCounter::End() {
  g_counting = false;
  return g_count;
}

int64_t AllocationCounter::Bytes() { return g_bytes; }

std::string AllocationCounter::First() {
  char** symbols = backtrace_symbols(g_frames, g_num_frames);
  std::string text;
  for (int i = 0; symbols != nullptr && i < g_num_frames; ++i) text += std::string(symbols[i]) + "\n";
  std::free(symbols);
  return text;
}

// operator new of the standard library calls these.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) noexcept {
  Count(size);
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) noexcept {
  Count(count * size);
  return __libc_calloc(count, size);
}
void* realloc(void* old, size_t size) noexcept {
  Count(size);
  return __libc_realloc(old, size);
}
void* memalign(size_t alignment, size_t size) noexcept {
  Count(size);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) noexcept {
  Count(size);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, size_t alignment, size_t size) noexcept {
  Count(size);
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
}

#else

void AllocationCounter::Begin() {}
int64_t AllocationCounter::End() { return 0; }
int64_t AllocationCounter::Bytes() { return 0; }
std::string AllocationCounter::First() { return {}; }

#endif

}  // namespace oraclegs
