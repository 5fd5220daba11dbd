#pragma once
// Marks functions that compile for the host and, under nvcc, for the device. On the host they are always inlined: with
// numbers that are vectors, a call passes its arguments through memory.

#if defined(__CUDACC__)
#define ORACLEGS_HD __host__ __device__
#else
#define ORACLEGS_HD [[gnu::always_inline]]
#endif
