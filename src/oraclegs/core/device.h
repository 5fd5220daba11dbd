#pragma once

#include <cstdint>
#include <string>

namespace oraclegs {

enum class DeviceKind : uint8_t { kCpu, kCuda };

/// Where numbers lie and who computes with them: the host, or one NVIDIA GPU.
struct Device {
  DeviceKind kind = DeviceKind::kCpu;
  int index = 0;  ///< number of the GPU, from 0

  bool is_cpu() const { return kind == DeviceKind::kCpu; }
  bool is_cuda() const { return kind == DeviceKind::kCuda; }
  /// "cpu", "cuda:0": what --device takes.
  std::string Name() const { return is_cpu() ? "cpu" : "cuda:" + std::to_string(index); }
  bool operator==(const Device&) const = default;
};

inline constexpr Device kCpu{};

}  // namespace oraclegs
