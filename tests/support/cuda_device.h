#pragma once
// Tests of device code, also in .cu files: on the emulated device everywhere, on a real one in a build with CUDA
// (preset "cuda").

#include <gtest/gtest.h>

#include <vector>

#include "oraclegs/core/cuda/device_array.h"

namespace oraclegs {

#if defined(ORACLEGS_EMULATED_CUDA)
inline constexpr bool kEmulatedCuda = true;
#else
inline constexpr bool kEmulatedCuda = false;
#endif

/// Base of every suite that launches kernels.
template <class Base>
class OnDevice : public Base {
 protected:
  void SetUp() override {
    if (cuda::DeviceCount() == 0) GTEST_SKIP() << "needs an NVIDIA GPU";
  }
};
class CudaTest : public OnDevice<testing::Test> {};

template <class T>
std::vector<T> ToHost(const cuda::DeviceArray<T>& array, int64_t count) {
  std::vector<T> out(static_cast<size_t>(count));
  array.Download(count, out.data());
  return out;
}

}  // namespace oraclegs
