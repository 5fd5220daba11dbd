#include "oraclegs/settings/device.h"

#include <charconv>
#include <string_view>

#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/machine.h"
#include "oraclegs/networks/loader.h"

namespace oraclegs {
namespace {

constexpr const char* kNoCudaInLibtorch =
    "the libtorch behind them has no CUDA, or finds no GPU; build with one that has (-DCMAKE_PREFIX_PATH=...)";
constexpr std::string_view kCuda = "cuda", kCudaNumbered = "cuda:";

/// Number after "cuda:", 0 for "cuda"; -1 for any other text.
int CudaIndex(std::string_view text) {
  if (text == kCuda) return 0;
  if (text.substr(0, kCudaNumbered.size()) != kCudaNumbered) return -1;
  const std::string_view digits = text.substr(kCudaNumbered.size());
  int index = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  return error == std::errc() && end == digits.data() + digits.size() && index >= 0 && index < 128 ? index : -1;
}

/// Reason why no GPU can be used; empty when one can.
std::string WhyNoGpu(const DeviceSupport& support) {
  if (support.devices > 0) return "";
  if (!support.has_library && !support.driver) {
    return "this machine has no NVIDIA GPU with a driver, and this program no library for one (liboraclegs_cuda.so)";
  }
  if (!support.no_library.empty()) return support.no_library;
  if (!support.driver) return "this machine has no NVIDIA GPU with a working driver";
  return "the NVIDIA driver of this machine does not answer, or is too old; update it, and see what nvidia-smi says";
}

}  // namespace

DeviceSupport ProbeDevices() {
  DeviceSupport support;
  support.driver = HasNvidiaDriver();
  support.has_library = HasCudaLibrary();
  support.no_library = WhyNoCudaLibrary();
  if (support.no_library.empty()) support.devices = CudaFunction<decltype(cuda::DeviceCount)>("DeviceCount")();
  return support;
}

Device ChooseDevice(const std::string& text, const DeviceSupport& support) {
  if (text == "cpu") return kCpu;
  const std::string why = WhyNoGpu(support);
  if (text == "auto") return why.empty() ? Device{DeviceKind::kCuda, 0} : kCpu;
  const int index = CudaIndex(text);
  if (index < 0) throw UsageError("--device is '{}', must be auto, cpu, cuda or cuda:N", text);
  if (!why.empty()) throw UsageError("--device {}: {}, or use --device cpu", text, why);
  if (index >= support.devices) {
    throw UsageError("--device {}: this machine has {} NVIDIA GPU{}, numbered from 0", text, support.devices,
                     support.devices == 1 ? "" : "s");
  }
  return {DeviceKind::kCuda, index};
}

int64_t FreeBytes(Device device) {
  if (device.is_cpu()) return static_cast<int64_t>(AvailableMemory());
  CudaFunction<decltype(cuda::UseDevice)>("UseDevice")(device.index);
  return CudaFunction<decltype(cuda::MemoryOfDevice)>("MemoryOfDevice")().free;
}

void ReportDevice(Device device, const DeviceSupport& support, const Listener& listener) {
  if (device.is_cuda()) {
    listener(Note{fmt::format("computing on the GPU {}", device.Name())});
  } else if (support.devices == 0 && (support.driver || support.has_library)) {
    listener(Note{fmt::format("computing on the CPU: {}", WhyNoGpu(support))});
  }
}

std::string WhyNetworksOnCpu(const std::string& text, Device device, const DeviceSupport& support) {
  if (text == "cpu") return "";
  if (device.is_cpu()) return WhyNoGpu(support);
  return GetNetworks().has_cuda() ? "" : kNoCudaInLibtorch;
}

Device DeviceOfNetworks(const Networks& networks, Device device, const Listener& listener) {
  if (device.is_cpu() || networks.has_cuda()) return device;
  listener(Warning{fmt::format("networks compute on the CPU: {}", kNoCudaInLibtorch)});
  return kCpu;
}

}  // namespace oraclegs
