#pragma once
// Memory that device code works on, owned. Everything here belongs to the device that was current when it was made.
// The stream of all work is passed explicitly; null is the default stream, which libtorch uses too, so that kernels and
// tensors stay in order without an event.

#include <cstdint>
#include <type_traits>
#include <utility>

#include "oraclegs/core/cuda/check.h"
#include "oraclegs/core/cuda/memory.h"

namespace oraclegs::cuda {

/// Where all work is queued: the default stream, which is also the networks'.
inline constexpr cudaStream_t kStream = nullptr;

/// Device memory for items that every pass writes anew. Grows to the largest use and a quarter more, so that counts
/// which creep up from pass to pass do not allocate in each; growing waits for the device.
template <class T>
class DeviceArray {
 public:
  static_assert(std::is_trivially_copyable_v<T>);

  /// `purpose` stands in the error when memory ends ("the tile lists").
  explicit DeviceArray(const char* purpose) : purpose_(purpose) {}
  ~DeviceArray() { FreeDevice(items_); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;

  /// Makes room for `count` items. What was there is lost when it grows, and new items hold anything. Throws
  /// OutOfMemory (AllocateDevice), and is empty then.
  void Reserve(int64_t count) {
    if (count > capacity_) Replace(count + count / 4);
  }
  /// Makes room as Reserve does, without spare room: for arrays that keep their size.
  void ReserveExactly(int64_t count) {
    if (count > capacity_) Replace(count);
  }

  /// Copies from / to host memory and waits. For tests and set-up.
  void Upload(const T* from, int64_t count) {
    Reserve(count);
    Copy(items_, from, count, cudaMemcpyHostToDevice);
  }
  void Download(int64_t count, T* to) const { Copy(to, items_, count, cudaMemcpyDeviceToHost); }

  /// Bytes of the first `count` items become `byte`, in the order of the stream.
  void FillBytes(int byte, int64_t count, cudaStream_t stream) {
    if (count > 0) Check(cudaMemsetAsync(items_, byte, static_cast<size_t>(count) * sizeof(T), stream), purpose_);
  }

  int64_t capacity() const { return capacity_; }
  int64_t bytes() const { return capacity_ * static_cast<int64_t>(sizeof(T)); }
  T* data() { return items_; }
  const T* data() const { return items_; }

  friend void swap(DeviceArray& a, DeviceArray& b) {
    std::swap(a.purpose_, b.purpose_);
    std::swap(a.items_, b.items_);
    std::swap(a.capacity_, b.capacity_);
  }

 private:
  void Replace(int64_t count) {
    FreeDevice(items_);  // first, so that both are never held at once
    items_ = nullptr;
    capacity_ = 0;
    items_ = static_cast<T*>(AllocateDevice(count * static_cast<int64_t>(sizeof(T)), purpose_));
    capacity_ = count;
  }
  void Copy(T* to, const T* from, int64_t count, cudaMemcpyKind kind) const {
    if (count > 0) Check(cudaMemcpy(to, from, static_cast<size_t>(count) * sizeof(T), kind), purpose_);
  }

  const char* purpose_;
  T* items_ = nullptr;
  int64_t capacity_ = 0;
};

/// A moment in a stream.
class Event {
 public:
  Event() { Check(cudaEventCreate(&event_), "making an event"); }
  ~Event() { cudaEventDestroy(event_); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;

  void Record(cudaStream_t stream) { Check(cudaEventRecord(event_, stream), "recording an event"); }
  /// Waits until the device has come to it.
  void Wait() const { Check(cudaEventSynchronize(event_), "waiting for the GPU"); }
  /// Milliseconds from `earlier` to this event; the device has passed both.
  double MillisecondsSince(const Event& earlier) const {
    float ms = 0;
    Check(cudaEventElapsedTime(&ms, earlier.event_, event_), "measuring time on the GPU");
    return ms;
  }

 private:
  cudaEvent_t event_ = nullptr;
};

/// A value that comes back from the device while the host goes on.
template <class T>
class Readback {
 public:
  static_assert(std::is_trivially_copyable_v<T>);

  Readback() : value_(static_cast<T*>(AllocatePinned(sizeof(T), "a number from the GPU"))) {}
  ~Readback() { FreePinned(value_); }
  Readback(const Readback&) = delete;
  Readback& operator=(const Readback&) = delete;

  /// Asks for *from as it will be when the stream comes here.
  void Ask(const T* from, cudaStream_t stream) {
    Check(cudaMemcpyAsync(value_, from, sizeof(T), cudaMemcpyDeviceToHost, stream), "reading from the GPU");
    asked_.Record(stream);
  }
  /// Waits for the last Ask. Work that was sent after it goes on meanwhile.
  const T& Get() const {
    asked_.Wait();
    return *value_;
  }

 private:
  T* value_;
  Event asked_;
};

}  // namespace oraclegs::cuda
