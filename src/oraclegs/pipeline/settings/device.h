#pragma once
// What --device asks for, and what there is.


#include <string>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// What of a GPU this program can use.
struct DeviceSupport {
  bool built = false;       ///< the program was compiled with CUDA
  bool torch_cuda = false;  ///< its libtorch too, and it finds a GPU
  int devices = 0;          ///< NVIDIA GPUs whose driver answers
};

DeviceSupport ProbeDevices();

/// The device that `text` names: auto (cuda:0 where it can be used, else the CPU), cpu, cuda, cuda:N. Throws UsageError
/// for any other text, and when a GPU is asked for that cannot be used: the CPU never stands in silently.
Device ChooseDevice(const std::string& text, const DeviceSupport& support);

/// Bytes that are free on the device; 0 = nobody knows.
int64_t FreeBytes(Device device);

/// Says on which GPU is computed, or why a program that was built with CUDA cannot use one. Nothing of the CPU where
/// that was built for, or chosen although there is a GPU.
void TellDevice(Device device, const DeviceSupport& support, const Listener& listener);

}  // namespace oraclegs
