#pragma once
// Parts of this machine, as the kernel of Linux reports them. `root` is where proc lies.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

/// The name of the processor, "AMD EPYC 9R14"; empty where the kernel does not say.
std::string ProcessorName(const std::filesystem::path& root = "/");

/// Bytes of memory; 0 where nobody says.
uint64_t TotalMemory(const std::filesystem::path& root = "/");

/// NVIDIA GPUs, whether this program can use them or not.
struct NvidiaGpus {
  std::string driver;               ///< its version, "550.54.14"; empty = the kernel has none loaded
  std::vector<std::string> models;  ///< "NVIDIA H200", one for each
};

NvidiaGpus FindNvidiaGpus(const std::filesystem::path& root = "/");

/// True when NVIDIA's driver is there: the kernel's, or that of Windows around WSL2.
bool HasNvidiaDriver(const std::filesystem::path& root = "/");

}  // namespace oraclegs
