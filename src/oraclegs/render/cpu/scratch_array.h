#pragma once

#include <hwy/aligned_allocator.h>

#include <cstdint>
#include <new>
#include <type_traits>

namespace oraclegs::cpu {

/// Memory for items that every pass writes anew. Aligned for any vector and to cache lines; grows to the largest use
/// plus a quarter, so that slowly rising counts do not allocate in each pass.
template <class T>
class ScratchArray {
 public:
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  /// Makes room for `count` items. Growing loses the contents, and new items are uninitialized. Throws std::bad_alloc,
  /// and is empty then.
  void Reserve(int64_t count) {
    if (count <= capacity_) return;
    items_.reset();  // first, so that both are never held at once
    capacity_ = 0;
    const int64_t roomy = count + count / 4;
    items_ = hwy::AllocateAligned<T>(static_cast<size_t>(roomy));
    if (!items_) throw std::bad_alloc();
    capacity_ = roomy;
  }

  int64_t capacity() const { return capacity_; }
  T* data() { return items_.get(); }
  const T* data() const { return items_.get(); }

 private:
  hwy::AlignedFreeUniquePtr<T[]> items_;
  int64_t capacity_ = 0;
};

}  // namespace oraclegs::cpu
