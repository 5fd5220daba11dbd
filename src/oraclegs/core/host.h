#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace oraclegs {

/// The name of this machine as it can stand in a file's name: letters, digits, '.', '_' and '-' alone. "unknown" where
/// it has none. Numbers of processes mean something together with it only, where machines share a folder.
const std::string& HostName();

/// Bytes that the process can still take before the machine swaps or kills it: what the kernel calls available, or less
/// where a control group, of version 1 or 2, or one above it limits the process. 0 where nobody says. `root` is where
/// proc and sys lie.
uint64_t AvailableMemory(const std::filesystem::path& root = "/");

/// Largest memory the process has held so far, bytes.
int64_t PeakMemoryBytes();

}  // namespace oraclegs
