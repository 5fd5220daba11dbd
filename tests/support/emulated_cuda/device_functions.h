#pragma once
// What device code calls without a header: warps, atomics, mathematics. Atomics are plain: threads take turns.

#include <concepts>
#include <type_traits>

#include "support/emulated_cuda/threads.h"

inline void __syncthreads() { emulated_cuda::SyncBlock(0); }
inline int __syncthreads_count(int predicate) { return static_cast<int>(emulated_cuda::SyncBlock(predicate != 0)); }
inline int __syncthreads_or(int predicate) { return emulated_cuda::SyncBlock(predicate != 0) > 0; }
inline int __syncthreads_and(int predicate) { return emulated_cuda::SyncBlock(predicate == 0) == 0; }
inline void __syncwarp(unsigned mask = 0xffffffffu) { emulated_cuda::SyncWarp(mask, emulated_cuda::WarpOp::kSync, 0); }
inline void __threadfence() {}
inline void __threadfence_block() {}

namespace emulated_cuda {

template <class T>
uint64_t Pack(T value) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 8);
  uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(T));
  return bits;
}
template <class T>
T Unpack(uint64_t bits) {
  T value;
  std::memcpy(&value, &bits, sizeof(T));
  return value;
}

/// The value of lane `from`; one's own where `from` is not in the segment of `width` lanes.
template <class T>
T Shuffle(unsigned mask, T value, int from, int width) {
  const uint64_t* values = SyncWarp(mask, WarpOp::kShuffle, Pack(value));
  const int first = Lane() / width * width;
  if (from < first || from >= first + width || !(mask >> from & 1)) return value;
  return Unpack<T>(values[from]);
}

}  // namespace emulated_cuda

template <class T>
T __shfl_sync(unsigned mask, T value, int from, int width = 32) {
  const int first = emulated_cuda::Lane() / width * width;
  return emulated_cuda::Shuffle(mask, value, first + (from & (width - 1)), width);
}
template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned delta, int width = 32) {
  return emulated_cuda::Shuffle(mask, value, emulated_cuda::Lane() - static_cast<int>(delta), width);
}
template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned delta, int width = 32) {
  return emulated_cuda::Shuffle(mask, value, emulated_cuda::Lane() + static_cast<int>(delta), width);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, int lanes, int width = 32) {
  return emulated_cuda::Shuffle(mask, value, emulated_cuda::Lane() ^ lanes, width);
}
inline unsigned __ballot_sync(unsigned mask, int predicate) {
  const uint64_t* values = emulated_cuda::SyncWarp(mask, emulated_cuda::WarpOp::kVote, predicate != 0);
  unsigned bits = 0;
  for (int lane = 0; lane < 32; ++lane) {
    if ((mask >> lane & 1) && values[lane] != 0) bits |= 1u << lane;
  }
  return bits;
}
inline int __any_sync(unsigned mask, int predicate) { return __ballot_sync(mask, predicate) != 0; }
inline int __all_sync(unsigned mask, int predicate) { return __ballot_sync(mask, predicate) == mask; }

template <class T>
T atomicAdd(T* at, std::type_identity_t<T> value) {
  const T old = *at;
  *at = old + value;
  return old;
}
template <class T>
T atomicMax(T* at, std::type_identity_t<T> value) {
  const T old = *at;
  if (value > old) *at = value;
  return old;
}
template <class T>
T atomicMin(T* at, std::type_identity_t<T> value) {
  const T old = *at;
  if (value < old) *at = value;
  return old;
}
template <class T>
T atomicExch(T* at, std::type_identity_t<T> value) {
  const T old = *at;
  *at = value;
  return old;
}
template <class T>
T atomicCAS(T* at, std::type_identity_t<T> expected, std::type_identity_t<T> value) {
  const T old = *at;
  if (old == expected) *at = value;
  return old;
}
template <class T>
T atomicOr(T* at, std::type_identity_t<T> value) {
  const T old = *at;
  *at = old | value;
  return old;
}

template <class T>
T __ldg(const T* at) {
  return *at;
}
template <class T>
T __ldcs(const T* at) {
  return *at;
}
template <class T>
void __stcs(T* at, std::type_identity_t<T> value) {
  *at = value;
}
inline int __popc(unsigned x) { return __builtin_popcount(x); }
inline int __clz(int x) { return x == 0 ? 32 : __builtin_clz(static_cast<unsigned>(x)); }
inline int __ffs(int x) { return __builtin_ffs(x); }
inline unsigned __float_as_uint(float x) { return emulated_cuda::Unpack<unsigned>(emulated_cuda::Pack(x)); }
inline int __float_as_int(float x) { return emulated_cuda::Unpack<int>(emulated_cuda::Pack(x)); }
inline float __uint_as_float(unsigned x) { return emulated_cuda::Unpack<float>(emulated_cuda::Pack(x)); }
inline float __int_as_float(int x) { return emulated_cuda::Unpack<float>(emulated_cuda::Pack(x)); }
inline float rsqrtf(float x) { return 1.f / std::sqrt(x); }
inline float __expf(float x) { return std::exp(x); }
inline float __logf(float x) { return std::log(x); }
inline float __log2f(float x) { return std::log2(x); }
inline float __cosf(float x) { return std::cos(x); }
inline float __sinf(float x) { return std::sin(x); }
inline void __sincosf(float x, float* s, float* c) { *s = std::sin(x), *c = std::cos(x); }
inline float __powf(float x, float y) { return std::pow(x, y); }
inline float __fdividef(float x, float y) { return x / y; }
inline float __frcp_rn(float x) { return 1.f / x; }
inline float __fsqrt_rn(float x) { return std::sqrt(x); }
inline float __fmaf_rn(float x, float y, float z) { return std::fma(x, y, z); }
inline float __saturatef(float x) { return std::min(std::max(x, 0.f), 1.f); }
template <class T>
T min(T a, T b) {
  return b < a ? b : a;
}
template <class T>
T max(T a, T b) {
  return a < b ? b : a;
}
