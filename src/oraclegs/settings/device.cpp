#include "oraclegs/settings/device.h"

#include <charconv>
#include <string_view>

#include "oraclegs/core/config.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/host.h"
#include "oraclegs/networks/loader.h"
#if defined(ORACLEGS_CUDA)
#include "oraclegs/core/cuda/check.h"
#endif

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
  if (!support.built) return "this program was built without CUDA; build it with -DORACLEGS_CUDA=ON";
  if (support.devices == 0) return "this machine has no NVIDIA GPU with a working driver";
  return "";
}

}  // namespace

DeviceSupport ProbeDevices() {
  DeviceSupport support;
#if defined(ORACLEGS_CUDA)
  support.built = true;
  support.devices = cuda::DeviceCount();
#endif
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
#if defined(ORACLEGS_CUDA)
  if (device.is_cuda()) {
    cuda::UseDevice(device.index);
    return cuda::MemoryOfDevice().free;
  }
#endif
  return device.is_cpu() ? static_cast<int64_t>(AvailableMemory()) : 0;
}

void ReportDevice(Device device, const DeviceSupport& support, const Listener& listener) {
  if (device.is_cuda()) {
    listener(Note{fmt::format("computing on the GPU {}", device.Name())});
  } else if (support.built && !WhyNoGpu(support).empty()) {
    listener(Note{fmt::format("computing on the CPU: {}", WhyNoGpu(support))});
  }
}

std::string WhyNetworksOnCpu(const std::string& text, Device device, const DeviceSupport& support) {
  if (text == "cpu") return "";
  if (device.is_cpu()) return WhyNoGpu(support) + (support.built ? "" : " and with a libtorch that has CUDA");
  return GetNetworks().has_cuda() ? "" : kNoCudaInLibtorch;
}

Device DeviceOfNetworks(const Networks& networks, Device device, const Listener& listener) {
  if (device.is_cpu() || networks.has_cuda()) return device;
  listener(Warning{fmt::format("networks compute on the CPU: {}", kNoCudaInLibtorch)});
  return kCpu;
}

}  // namespace oraclegs
