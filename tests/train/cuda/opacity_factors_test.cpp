#include "oraclegs/train/cuda/opacity_factors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/train/opacity_factors.h"
#include "support/buffers.h"
#include "support/device_buffers.h"

namespace oraclegs::cuda {
namespace {

class CudaOpacityFactors : public CudaTest {};

TEST_F(CudaOpacityFactors, AreTheCpus) {
  constexpr int64_t kCount = 777;
  for (const auto& [drop, noise] : {std::pair{0.2, 0.0}, std::pair{0.0, 0.8}, std::pair{0.5, 3.0}}) {
    const Buffer<float> expected = Buffer<float>::Empty({kCount});
    DrawOpacityFactors({5, 123, drop, noise}, expected);
    const Buffer<float> factors = OnTestDevice(Buffer<float>::Full({kCount}, -1.f));
    RunOpacityFactors({5, 123, drop, noise, kCount, factors.data()}, nullptr);
    const Buffer<float> drawn = OnHost(factors);
    EXPECT_LE(MaxAbsError(drawn, expected), 1e-5);  // floats of up to 36
    EXPECT_TRUE(((Flat(drawn) == 0) == (Flat(expected) == 0)).all());
  }
}

}  // namespace
}  // namespace oraclegs::cuda
