#pragma once
// The engine's memory: arrays of numbers on the host or on a GPU, and the checks at the borders.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/shape.h"

namespace oraclegs {

enum class DeviceKind : uint8_t { kCpu, kCuda };

/// Where numbers lie and who computes with them: the host, or one NVIDIA GPU.
struct Device {
  DeviceKind kind = DeviceKind::kCpu;
  int index = 0;  ///< of the GPU, from 0

  bool is_cpu() const { return kind == DeviceKind::kCpu; }
  bool is_cuda() const { return kind == DeviceKind::kCuda; }
  /// "cpu", "cuda:0": what --device takes.
  std::string Name() const { return is_cpu() ? "cpu" : "cuda:" + std::to_string(index); }
  bool operator==(const Device&) const = default;
};

inline constexpr Device kCpu{};

/// Bytes of memory on a device: host memory starts at a multiple of 64, freed with the last handle. Throws OutOfMemory
/// (a GPU), UsageError for a device that this build cannot use.
class Storage {
 public:
  static std::shared_ptr<Storage> Allocate(int64_t bytes, Device device, const char* purpose);
  /// Memory that somebody else owns: `owner` is kept as long as this lives.
  static std::shared_ptr<Storage> Wrap(void* data, int64_t bytes, Device device, std::shared_ptr<const void> owner);
  ~Storage();
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  void* data() const { return data_; }
  int64_t bytes() const { return bytes_; }
  Device device() const { return device_; }
  const std::shared_ptr<const void>& owner() const { return owner_; }

 private:
  Storage() = default;

  void* data_ = nullptr;
  int64_t bytes_ = 0;
  Device device_;
  std::shared_ptr<const void> owner_;  // null = the memory is our own
};

/// Copies between any two devices, and waits until it is done.
void CopyBytes(void* to, Device to_device, const void* from, Device from_device, int64_t bytes);
void FillWithZeros(void* data, Device device, int64_t bytes);

/// An array of numbers on one device: contiguous, row-major, of fixed type. A handle, like a std::shared_ptr: copies
/// show the same numbers, Clone makes new ones, and a const handle still lets its numbers be written. A default one is
/// undefined, which functions use for "not given".
template <class T>
class Buffer {
 public:
  static_assert(std::is_trivially_copyable_v<T>);

  Buffer() = default;

  /// `purpose`, a plural, stands in the error when memory ends ("the rendered images").
  static Buffer Empty(const Shape& shape, Device device = kCpu, const char* purpose = "an array") {
    const int64_t bytes = shape.count() * static_cast<int64_t>(sizeof(T));
    return Buffer(Storage::Allocate(bytes, device, purpose), 0, shape);
  }
  static Buffer Zeros(const Shape& shape, Device device = kCpu, const char* purpose = "an array") {
    Buffer buffer = Empty(shape, device, purpose);
    buffer.SetZero();
    return buffer;
  }
  /// On the host.
  static Buffer Full(const Shape& shape, T value) {
    Buffer buffer = Empty(shape);
    std::fill_n(buffer.data(), buffer.count(), value);
    return buffer;
  }
  /// A copy of host memory. Throws ShapeError when there are more or fewer values than the shape has.
  static Buffer From(const Shape& shape, std::span<const T> values) {
    if (static_cast<int64_t>(values.size()) != shape.count()) {
      throw ShapeError("{} values for an array of shape {}", values.size(), shape.Text());
    }
    Buffer buffer = Empty(shape);
    std::copy(values.begin(), values.end(), buffer.data());
    return buffer;
  }
  static Buffer From(const Shape& shape, std::initializer_list<T> values) {
    return From(shape, std::span<const T>(values.begin(), values.size()));
  }
  /// Shows memory of somebody else; `owner` is kept as long as a handle is.
  static Buffer Wrap(T* data, const Shape& shape, Device device, std::shared_ptr<const void> owner) {
    return Buffer(Storage::Wrap(data, shape.count() * static_cast<int64_t>(sizeof(T)), device, std::move(owner)), 0,
                  shape);
  }

  bool defined() const { return storage_ != nullptr; }
  const Shape& shape() const { return shape_; }
  int dims() const { return shape_.dims(); }
  int64_t size(int dimension) const { return shape_[dimension]; }
  int64_t count() const { return defined() ? shape_.count() : 0; }
  int64_t bytes() const { return count() * static_cast<int64_t>(sizeof(T)); }
  Device device() const { return defined() ? storage_->device() : kCpu; }
  const std::shared_ptr<Storage>& storage() const { return storage_; }

  T* data() const { return defined() ? static_cast<T*>(storage_->data()) + offset_ : nullptr; }
  /// The elements of a buffer on the host; operator[] needs one there, too.
  std::span<T> span() const { return {data(), static_cast<size_t>(count())}; }
  T& operator[](int64_t i) const { return data()[i]; }

  /// A copy of the numbers in new memory, on their device or on another.
  Buffer Clone() const { return CopyOn(device()); }
  Buffer CopyOn(Device device) const {
    if (!defined()) return {};
    Buffer copy = Empty(shape_, device);
    CopyBytes(copy.data(), device, data(), this->device(), bytes());
    return copy;
  }
  /// The buffer itself where it lies on that device already.
  Buffer To(Device device) const { return !defined() || device == this->device() ? *this : CopyOn(device); }
  /// Throws ShapeError unless `from` has as many numbers.
  void CopyFrom(const Buffer& from) const {
    if (from.count() != count()) throw ShapeError("{} is copied to {}", from.shape().Text(), shape_.Text());
    CopyBytes(data(), device(), from.data(), from.device(), bytes());
  }
  void SetZero() const { FillWithZeros(data(), device(), bytes()); }

  /// The first numbers, seen in another shape that has no more of them.
  Buffer Head(const Shape& shape) const {
    if (shape.count() > count()) throw ShapeError("{} has no room for {}", shape_.Text(), shape.Text());
    return Buffer(storage_, offset_, shape);
  }
  /// Rows [begin, end) of the first dimension. Throws ShapeError.
  Buffer Rows(int64_t begin, int64_t end) const {
    if (begin < 0 || begin > end || end > size(0)) throw ShapeError("rows {} to {} of {}", begin, end, shape_.Text());
    return Buffer(storage_, offset_ + begin * shape_.row(), shape_.WithRows(end - begin));
  }
  /// A buffer of `rows` rows, these and behind them others that hold anything: in this memory where it has room, else
  /// in new memory with half as much again to spare.
  Buffer GrownTo(int64_t rows) const {
    if (rows <= size(0)) return Rows(0, rows);
    const int64_t bytes = (offset_ + rows * shape_.row()) * static_cast<int64_t>(sizeof(T));
    if (storage_->bytes() >= bytes) return Buffer(storage_, offset_, shape_.WithRows(rows));
    Buffer grown = Empty(shape_.WithRows(std::max(rows, size(0) + size(0) / 2)), device());
    CopyBytes(grown.data(), device(), data(), device(), this->bytes());
    return grown.Rows(0, rows);
  }

 private:
  Buffer(std::shared_ptr<Storage> storage, int64_t offset, const Shape& shape)
      : storage_(std::move(storage)), offset_(offset), shape_(shape) {}

  std::shared_ptr<Storage> storage_;
  int64_t offset_ = 0;  // in T
  Shape shape_;
};

/// Throws ShapeError "WHO: NAME is [3, 4], expected [any, 3]" unless the buffer is defined and of that shape; -1 stands
/// for any size.
void RequireShape(const char* who, const char* name, bool defined, const Shape& shape,
                  std::initializer_list<int64_t> expected);
template <class T>
void RequireShape(const char* who, const char* name, const Buffer<T>& buffer, std::initializer_list<int64_t> expected) {
  RequireShape(who, name, buffer.defined(), buffer.shape(), expected);
}

}  // namespace oraclegs
