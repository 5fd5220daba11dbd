#pragma once
// Choice of the device for --device, from those of this machine.

#include <string>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs {

/// Support for GPUs on this machine.
struct DeviceSupport {
  int devices = 0;      ///< number of NVIDIA GPUs that this program can compute on
  bool driver = false;  ///< true when NVIDIA's driver is there
  /// Why the library of device code (core/cuda_library.h) cannot be used; empty = it can.
  std::string no_library = {};
  bool has_library = true;  ///< false when there is no such file
};

DeviceSupport ProbeDevices();

/// Device that `text` names: auto (cuda:0 where it can be used, else the CPU), cpu, cuda, cuda:N. Throws UsageError for
/// any other text, and for a GPU that cannot be used: the CPU never replaces it silently.
Device ChooseDevice(const std::string& text, const DeviceSupport& support);

/// Free memory of the device in bytes; 0 = unknown.
int64_t FreeBytes(Device device);

/// Notes which GPU computes, or, where a GPU's driver or the library is there and the other one is not, what is
/// missing. Says nothing where neither is there, or when the CPU was chosen on a machine with a GPU.
void ReportDevice(Device device, const DeviceSupport& support, const Listener& listener);

/// Why networks would compute on a CPU that nobody asked for, and what helps: the start of a message. "" where a GPU
/// computes them, or `text`, --device, is "cpu". Loads the library of networks where the engine has a GPU.
std::string WhyNetworksOnCpu(const std::string& text, Device device, const DeviceSupport& support);

/// Device of networks beside an engine on `device`: the same one, or, with a warning, the CPU where their libtorch has
/// no CUDA.
Device DeviceOfNetworks(const Networks& networks, Device device, const Listener& listener);

}  // namespace oraclegs
