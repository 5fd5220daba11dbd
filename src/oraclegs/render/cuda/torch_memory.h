#pragma once
// Device memory that libtorch takes.

#include <string>

#include "oraclegs/core/cuda/check.h"
#include "oraclegs/core/out_of_memory.h"
#include "oraclegs/core/buffer.h"

namespace oraclegs::cuda {

/// Runs what takes memory of libtorch for `purpose`, a plural ("the rendered pictures"); libtorch's error for too
/// little of it becomes OutOfMemory. `lower` says what would need less.
template <class F>
auto WithMemory(const char* purpose, const F& work, const char* lower = "lower --max-gaussians or raise --downscale") {
  try {
    return work();
  } catch (const c10::Error& error) {
    const std::string what = error.what_without_backtrace();
    if (what.find("out of memory") == std::string::npos) throw;
    throw OutOfMemory("out of GPU memory for {}, with {:.2f} GB free ({}); {}", purpose,
                      static_cast<double>(MemoryOfDevice().free) * 1e-9, what.substr(0, what.find('\n')), lower);
  }
}

}  // namespace oraclegs::cuda
