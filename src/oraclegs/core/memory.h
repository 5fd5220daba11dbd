#pragma once

#include <cstdint>

namespace oraclegs {

/// Bytes that the process can still take before the machine swaps or kills it: what the kernel calls available, or less
/// where a control group limits the process. 0 where nobody says.
uint64_t AvailableMemory();

/// Largest memory the process has held so far, bytes.
int64_t PeakMemoryBytes();

}  // namespace oraclegs
