#include "bench/gpu_once.h"

#include <gmock/gmock.h>

#include "support/cuda_device.h"

namespace oraclegs {
namespace {

class GpuOnceTest : public CudaTest {};

TEST_F(GpuOnceTest, MeasuresBothDevices) {
  const GpuOnce once = MeasureOnce({100, 16, 12}, 3, 1);
  for (const double ms : {once.neighbors.gpu, once.neighbors.cpu, once.warp.gpu, once.warp.cpu}) EXPECT_GT(ms, 0);
}

TEST(GpuOnceTextTest, SaysWhatWasMeasured) {
  EXPECT_EQ(OnceText({1000, 12, {0.25, 30}, {4, 5000}}),
            "three nearest neighbours of 1000 points: 0.2 ms, on the CPU 30 ms\n"
            "a view warped from 12 photographs: 4.0 ms, on the CPU 5000 ms\n");
}

}  // namespace
}  // namespace oraclegs
