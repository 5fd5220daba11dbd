#include "oraclegs/core/buffer.h"

#include <new>
#include <utility>

#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/cuda_library.h"

namespace oraclegs {
namespace {

constexpr std::align_val_t kAlignment{64};  // a cache line, the widest vector

void UseDevice(Device device) { CudaFunction<decltype(cuda::UseDevice)>("UseDevice")(device.index); }

}  // namespace

std::shared_ptr<Storage> Storage::Allocate(int64_t bytes, Device device, const char* purpose) {
  std::shared_ptr<Storage> storage(new Storage());
  storage->device_ = device;
  if (device.is_cpu()) {
    storage->data_ = ::operator new(static_cast<size_t>(std::max<int64_t>(bytes, 1)), kAlignment);
  } else {
    UseDevice(device);
    storage->data_ = CudaFunction<decltype(cuda::AllocateDevice)>("AllocateDevice")(bytes, purpose);
  }
  storage->bytes_ = bytes;
  return storage;
}

std::shared_ptr<Storage> Storage::Wrap(void* data, int64_t bytes, Device device, std::shared_ptr<const void> owner) {
  static const std::shared_ptr<const void> nobody = std::make_shared<int>();
  std::shared_ptr<Storage> storage(new Storage());
  storage->data_ = data;
  storage->bytes_ = bytes;
  storage->device_ = device;
  if (!owner) owner = nobody;
  storage->owner_ = std::move(owner);
  return storage;
}

Storage::~Storage() {
  if (owner_ || data_ == nullptr) return;
  if (device_.is_cpu()) ::operator delete(data_, kAlignment);
  if (device_.is_cuda()) CudaFunction<decltype(cuda::FreeDevice)>("FreeDevice")(data_);
}

void CopyBytes(void* to, Device to_device, const void* from, Device from_device, int64_t bytes) {
  if (bytes == 0) return;
  if (to_device.is_cpu() && from_device.is_cpu()) {
    std::memmove(to, from, static_cast<size_t>(bytes));
    return;
  }
  UseDevice(to_device.is_cuda() ? to_device : from_device);
  CudaFunction<decltype(cuda::Copy)>("Copy")(to, from, bytes);
}

void FillWithZeros(void* data, Device device, int64_t bytes) {
  if (bytes == 0) return;
  if (device.is_cpu()) {
    std::memset(data, 0, static_cast<size_t>(bytes));
    return;
  }
  UseDevice(device);
  CudaFunction<decltype(cuda::FillWithZeros)>("FillWithZeros")(data, bytes);
}

void RequireShape(const char* who, const char* name, bool defined, const Shape& shape,
                  std::initializer_list<int64_t> expected) {
  const auto fits = [](int64_t size, int64_t wanted) { return wanted == -1 || size == wanted; };
  if (defined && std::equal(shape.begin(), shape.end(), expected.begin(), expected.end(), fits)) return;
  std::string wanted;
  for (const int64_t size : expected) {
    wanted += (wanted.empty() ? "" : ", ") + (size == -1 ? std::string("any") : std::to_string(size));
  }
  if (!defined) throw ShapeError("{}: {} is undefined, expected [{}]", who, name, wanted);
  throw ShapeError("{}: {} is {}, expected [{}]", who, name, shape.Text(), wanted);
}

}  // namespace oraclegs
