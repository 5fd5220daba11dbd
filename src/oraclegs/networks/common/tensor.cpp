#include "oraclegs/networks/common/tensor.h"

#include <memory>

namespace oraclegs {

torch::Device ToTorch(Device device) {
  if (device.is_cpu()) return torch::kCPU;
  return {torch::kCUDA, static_cast<c10::DeviceIndex>(device.index)};
}

Device FromTorch(const torch::Device& device) {
  if (device.is_cpu()) return kCpu;
  if (!device.is_cuda()) throw ShapeError("no buffer lies on the device {}", device.str());
  return {DeviceKind::kCuda, device.has_index() ? device.index() : 0};
}

Tensor TensorOf(const Buffer<float>& buffer) {
  if (!buffer.defined()) return {};
  const std::vector<int64_t> sizes(buffer.shape().begin(), buffer.shape().end());
  const auto options = torch::TensorOptions(torch::kFloat).device(ToTorch(buffer.device()));
  // The deleter keeps the memory as long as any tensor of it.
  return torch::from_blob(
      buffer.data(), sizes, [keep = buffer.storage()](void*) {}, options);
}

Buffer<float> BufferOf(const Tensor& tensor) {
  if (!tensor.defined()) return {};
  if (tensor.scalar_type() != torch::kFloat) {
    throw ShapeError("BufferOf: the tensor is {}, expected float32", c10::toString(tensor.scalar_type()));
  }
  const auto owner = std::make_shared<const Tensor>(tensor.contiguous());
  const at::IntArrayRef sizes = owner->sizes();
  return Buffer<float>::Wrap(owner->data_ptr<float>(), Shape(std::span<const int64_t>(sizes.data(), sizes.size())),
                             FromTorch(owner->device()), owner);
}

}  // namespace oraclegs
