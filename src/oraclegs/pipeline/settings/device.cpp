#include "oraclegs/pipeline/settings/device.h"


#include <charconv>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/memory.h"
#if defined(ORACLEGS_CUDA)
#include "oraclegs/core/cuda/check.h"
#if __has_include(<c10/cuda/CUDACachingAllocator.h>)  // not in a libtorch for the CPU
#include <c10/cuda/CUDACachingAllocator.h>
#define ORACLEGS_TORCH_KEEPS_MEMORY 1
#endif
#endif

namespace oraclegs {
namespace {

constexpr std::string_view kCuda = "cuda", kCudaNumbered = "cuda:";

/// The number behind "cuda:", 0 without one; -1 for any other text.
int CudaIndex(std::string_view text) {
  if (text == kCuda) return 0;
  if (text.substr(0, kCudaNumbered.size()) != kCudaNumbered) return -1;
  const std::string_view digits = text.substr(kCudaNumbered.size());
  int index = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  return error == std::errc() && end == digits.data() + digits.size() && index >= 0 && index < 128 ? index : -1;
}

/// Why no GPU can be used; empty when one can.
std::string WhyNoGpu(const DeviceSupport& support) {
  if (!support.built) return "this program was built without CUDA; build it with -DORACLEGS_CUDA=ON";
  if (support.devices == 0) return "this machine has no NVIDIA GPU with a working driver";
  if (!support.torch_cuda) return "the libtorch that this program was built with has no CUDA; build with one that has";
  return "";
}

}  // namespace

DeviceSupport ProbeDevices() {
  DeviceSupport support;
#if defined(ORACLEGS_CUDA)
  support.built = true;
  support.torch_cuda = torch::cuda::is_available();
  support.devices = cuda::DeviceCount();
#if defined(ORACLEGS_TORCH_KEEPS_MEMORY)
  if (support.torch_cuda) cuda::SetOutOfMemoryCallback([] { c10::cuda::CUDACachingAllocator::emptyCache(); });
#endif
#endif
  return support;
}

Device ChooseDevice(const std::string& text, const DeviceSupport& support) {
  if (text == "cpu") return kCpu;
  const std::string why = WhyNoGpu(support);
  if (text == "auto") return why.empty() ? Device(torch::kCUDA, 0) : Device(kCpu);
  const int index = CudaIndex(text);
  if (index < 0) throw UsageError("--device is '{}', must be auto, cpu, cuda or cuda:N", text);
  if (!why.empty()) throw UsageError("--device {}: {}, or use --device cpu", text, why);
  if (index >= support.devices) {
    throw UsageError("--device {}: this machine has {} NVIDIA GPU{}, numbered from 0", text, support.devices,
                     support.devices == 1 ? "" : "s");
  }
  return {torch::kCUDA, static_cast<int8_t>(index)};
}

int64_t FreeBytes(Device device) {
#if defined(ORACLEGS_CUDA)
  if (device.is_cuda()) {
    cuda::UseDevice(device.index());
    return cuda::MemoryOfDevice().free;
  }
#endif
  return device.is_cpu() ? static_cast<int64_t>(AvailableMemory()) : 0;
}

void TellDevice(Device device, const DeviceSupport& support, const Listener& listener) {
  if (device.is_cuda()) {
    listener(Note{fmt::format("computing on the GPU {}", device.str())});
  } else if (support.built && !WhyNoGpu(support).empty()) {
    listener(Note{fmt::format("computing on the CPU: {}", WhyNoGpu(support))});
  }
}

}  // namespace oraclegs
