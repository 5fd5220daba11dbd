#pragma once
// Instruction sets that the kernels are not built for: their vectors have no compile-time size, which lanes-inl.h
// needs. With sanitizers also all but two of the others, because each takes as long to compile.

#ifdef ORACLEGS_FEW_HWY_TARGETS
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)
#else
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
