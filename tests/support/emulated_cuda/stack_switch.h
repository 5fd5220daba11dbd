#pragma once
// What the address sanitizer must know when a thread goes on with another stack. Nothing without it.

#include <cstddef>

#if defined(__SANITIZE_ADDRESS__)
#define ORACLEGS_EMULATED_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ORACLEGS_EMULATED_ASAN 1
#endif
#endif

#if defined(ORACLEGS_EMULATED_ASAN)
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

namespace emulated_cuda {

struct StackOfOthers {
  const void* bottom = nullptr;
  size_t bytes = 0;
};

/// One stay on another stack: Leave() before the jump, ComeBack() after the jump back.
class StackSwitch {
 public:
  explicit StackSwitch(StackOfOthers* other) : other_(other) {}

#if defined(ORACLEGS_EMULATED_ASAN)
  void Leave() { __sanitizer_start_switch_fiber(&kept_, other_->bottom, other_->bytes); }
  void ComeBack() { __sanitizer_finish_switch_fiber(kept_, nullptr, nullptr); }

  /// The first thing on a new stack; `from` becomes the stack that the thread came from.
  static void Arrive(StackOfOthers* from) { __sanitizer_finish_switch_fiber(nullptr, &from->bottom, &from->bytes); }

  /// Replaces Leave() where the fiber does not come back.
  static void LeaveForGood(const StackOfOthers& to) { __sanitizer_start_switch_fiber(nullptr, to.bottom, to.bytes); }
#else
  void Leave() { (void)other_; }
  void ComeBack() {}
  static void Arrive(StackOfOthers*) {}
  static void LeaveForGood(const StackOfOthers&) {}
#endif

 private:
  StackOfOthers* other_;
  void* kept_ = nullptr;
};

/// Resets a reused stack: the sanitizer forgets the frames that were left on it.
inline void ForgetFrames(void* bottom, size_t bytes) {
#if defined(ORACLEGS_EMULATED_ASAN)
  __asan_unpoison_memory_region(bottom, bytes);
#else
  (void)bottom, (void)bytes;
#endif
}

}  // namespace emulated_cuda
