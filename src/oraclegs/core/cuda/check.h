#pragma once
// Every CUDA call goes through Check, every launch through Launch (launch.h): an error is thrown where it is first
// seen.

#include <cuda_runtime.h>

namespace oraclegs::cuda {

/// Does nothing after success. Throws UsageError when there is no device or the driver is too old, RunError otherwise,
/// "WHAT: ...": `what` says in the user's terms what was being done.
void Check(cudaError_t status, const char* what);

/// After a launch: the launch itself, and what earlier kernels left behind.
void CheckLaunch(const char* kernel);

}  // namespace oraclegs::cuda
