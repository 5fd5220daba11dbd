#pragma once

namespace oraclegs {

/// How long this machine takes for a fixed piece of training on the CPU, as a factor of the reference machine's time
/// (two cores of an AMD EPYC with AVX-512 that do nothing else; docs/benchmarks.md): 2 = half as fast. Takes about half
/// a second, measured once a process, with the threads of SetNumThreads.
double CpuSlowness();

}  // namespace oraclegs
