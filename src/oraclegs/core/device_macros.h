#pragma once
// Marks functions that compile for the host and, under nvcc, for the device.

#if defined(__CUDACC__)
#define ORACLEGS_HD __host__ __device__
#else
#define ORACLEGS_HD
#endif
