#include "oraclegs/networks/vggt/camera_head.h"

#include <cmath>

#include "networks/vggt/fixture.h"

namespace oraclegs::vggt {
namespace {

class CameraHeadParity : public OnThreads {};

TEST_P(CameraHeadParity, EncodingsAndCamerasMatchTheOfficialHead) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const CameraHead head = *GoldenVggt().camera_head;
  const std::string last = "output.aggregated_tokens." + std::to_string(Count(file, "depth") - 1);
  const std::vector<Tensor> encodings = CameraEncodings(head, GoldenFloat(file, last).select(1, 0));
  ASSERT_EQ(static_cast<int64_t>(encodings.size()), head.config.iterations);
  for (size_t i = 0; i < encodings.size(); ++i) {
    ExpectGolden(encodings[i], file, "debug.pose_enc.iter" + std::to_string(i), 5e-5);
  }
  ExpectGolden(encodings.back(), file, "output.pose_enc", 5e-5);
  const DecodedCameras cameras = DecodeCameras(encodings.back(), Count(file, "height"), Count(file, "width"));
  ExpectGolden(cameras.extrinsics, file, "output.extrinsics", 5e-5);
  ExpectGolden(cameras.intrinsics, file, "output.intrinsics", 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Threads, CameraHeadParity, testing::ValuesIn(ThreadsAndGpu()));

TEST(DecodeCameras, AQuarterTurnAndFieldsOfView) {
  const float root = std::sqrt(0.5f), vertical = 2 * std::atan(0.5f), horizontal = 2 * std::atan(0.25f);
  // A quaternion of another length turns the same way: about z, x to y.
  const Tensor encoding = torch::tensor({{1.f, 2.f, 3.f, 0.f, 0.f, 3 * root, 3 * root, vertical, horizontal}});
  const DecodedCameras cameras = DecodeCameras(encoding, 40, 60);
  const Tensor extrinsics = torch::tensor({{0.f, -1.f, 0.f, 1.f}, {1.f, 0.f, 0.f, 2.f}, {0.f, 0.f, 1.f, 3.f}});
  EXPECT_LT(MaxAbsError(cameras.extrinsics[0], extrinsics), 1e-6);
  const Tensor intrinsics = torch::tensor({{120.f, 0.f, 30.f}, {0.f, 40.f, 20.f}, {0.f, 0.f, 1.f}});
  EXPECT_LT(MaxAbsError(cameras.intrinsics[0], intrinsics), 1e-4);
  EXPECT_TRUE(cameras.without_focal.empty());
}

TEST(DecodeCameras, AnEmptyFieldOfViewIsTold) {
  Tensor encoding = torch::ones({3, 9});
  encoding[1][8] = 0;
  const DecodedCameras cameras = DecodeCameras(encoding, 40, 60);
  EXPECT_EQ(cameras.without_focal, std::vector<int64_t>{1});
  EXPECT_TRUE(std::isinf(cameras.intrinsics[1][0][0].item<float>()));
}

TEST(CameraHead, RefusesTokensOfAnotherWidth) {
  const SafetensorsFile file = OpenGolden(kVggtFixture);
  const CameraHead head = *GoldenVggt().camera_head;
  EXPECT_THROW(CameraEncodings(head, torch::rand({3, head.config.width - 1})), ShapeError);
  EXPECT_THROW(CameraEncodings(head, torch::rand({1, 3, head.config.width})), ShapeError);
  EXPECT_THROW(DecodeCameras(torch::rand({3, 8}), 40, 60), ShapeError);
}

}  // namespace
}  // namespace oraclegs::vggt
