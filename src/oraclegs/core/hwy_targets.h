#pragma once
// Instruction sets that the kernels are not built for: their vectors have no compile-time size, which lanes-inl.h
// needs.

#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
