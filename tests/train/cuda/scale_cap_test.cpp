#include "oraclegs/train/cuda/scale_cap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/cuda/device_array.h"
#include "oraclegs/train/scale_cap.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs::cuda {
namespace {

class CudaScaleCap : public CudaTest {};

TEST_F(CudaScaleCap, IsTheCpus) {
  const Gaussians start = RandomGaussians(500, 3);
  Flat(start.log_scales) += 2;
  const std::vector<float> centers = CameraCenters(Photos(4));
  Gaussians expected = start.Clone();
  CapScales(centers, 0.7, &expected);
  ASSERT_FALSE(Equal(expected.log_scales, start.log_scales));
  DeviceArray<float> on_device("a test");
  on_device.Upload(centers.data(), static_cast<int64_t>(centers.size()));
  const Gaussians gaussians = OnTestDevice(start);
  const auto log_share = static_cast<float>(std::log(0.7));
  RunCapScales({gaussians.Rows(), 500, on_device.data(), 4, log_share}, nullptr);
  EXPECT_LE(MaxAbsError(OnHost(gaussians.log_scales), expected.log_scales), 1e-5);
  RunCapScales({gaussians.Rows(), 500, nullptr, 0, log_share}, nullptr);
  EXPECT_LE(MaxAbsError(OnHost(gaussians.log_scales), expected.log_scales), 1e-5);
}

}  // namespace
}  // namespace oraclegs::cuda
