#pragma once

namespace oraclegs {

/// Time that this machine takes for a fixed piece of training on the CPU, divided by that of the reference machine (two
/// idle cores of an AMD EPYC with AVX-512; docs/benchmarks.md): 2 = half as fast. Takes about half a second, measured
/// once a process, with the threads of SetNumThreads.
double CpuSlowness();

}  // namespace oraclegs
