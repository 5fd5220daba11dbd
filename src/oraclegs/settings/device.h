#pragma once
// What --device asks for, and what there is.

#include <string>

#include "oraclegs/core/device.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs {

/// What of a GPU this program can use.
struct DeviceSupport {
  bool built = false;  ///< the program was compiled with CUDA
  int devices = 0;     ///< NVIDIA GPUs whose driver answers
};

DeviceSupport ProbeDevices();

/// The device that `text` names: auto (cuda:0 where it can be used, else the CPU), cpu, cuda, cuda:N. Throws UsageError
/// for any other text, and when a GPU is asked for that cannot be used: the CPU never stands in silently.
Device ChooseDevice(const std::string& text, const DeviceSupport& support);

/// Bytes that are free on the device; 0 = unknown.
int64_t FreeBytes(Device device);

/// Notes which GPU computes, or why a program that was built with CUDA cannot use one. Nothing of the CPU where that
/// was built for, or chosen although there is a GPU.
void ReportDevice(Device device, const DeviceSupport& support, const Listener& listener);

/// Where networks compute beside an engine on `device`: there too, or, with a warning, on the CPU where their libtorch
/// has no CUDA.
Device DeviceOfNetworks(const Networks& networks, Device device, const Listener& listener);

}  // namespace oraclegs
