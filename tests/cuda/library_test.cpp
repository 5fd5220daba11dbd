// The engine through the library of device code that is loaded: that of the emulated device, or of this machine's GPU.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/cuda_library.h"
#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/render/render.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

constexpr Device kGpu{DeviceKind::kCuda, 0};

class CudaLibrary : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(WhyNoCudaLibrary(), "");
    if (CudaFunction<decltype(cuda::DeviceCount)>("DeviceCount")() == 0) GTEST_SKIP() << "there is no GPU";
  }
};

TEST_F(CudaLibrary, KnowsItsFunctionsByName) {
  EXPECT_GE(CudaFunction<decltype(cuda::RuntimeVersion)>("RuntimeVersion")(), 12000);
  CudaFunction<decltype(cuda::UseDevice)>("UseDevice")(0);
  EXPECT_GT(CudaFunction<decltype(cuda::MemoryOfDevice)>("MemoryOfDevice")().free, 0);
  EXPECT_THROW(CudaSymbol("no_such_function"), RunError);
}

TEST_F(CudaLibrary, KeepsBuffers) {
  const auto numbers = Buffer<float>::From({2, 3}, {1, 2, 3, 4, 5, 6});
  const Buffer<float> there = numbers.CopyOn(kGpu), zeros = Buffer<float>::Zeros({2, 3}, kGpu);
  EXPECT_EQ(there.device(), kGpu);
  EXPECT_THAT(there.Clone().To(kCpu).span(), testing::ElementsAre(1, 2, 3, 4, 5, 6));
  there.CopyFrom(zeros);
  EXPECT_THAT(there.To(kCpu).span(), testing::Each(0.f));
  EXPECT_THROW((Buffer<float>::Zeros({3}, {DeviceKind::kCuda, 99})), UsageError);
}

TEST_F(CudaLibrary, RendersAndTrainsAsTheCpuDoes) {
  const TrainOptions options = Options(30);
  const auto train = [&](Device device) {
    Trainer trainer({options, kSeed, {0.1f, 0.2f, 0.3f}, TrainingData(Photos(3), {}), Start()},
                    [&](const TrainDeviceSetup& setup) { return MakeTrainDevice(device, setup); });
    double loss = 0;
    for (int i = 0; i < 20; ++i) loss = trainer.Step();
    return loss;
  };
  const double on_cpu = train(kCpu);
  EXPECT_NEAR(train(kGpu), on_cpu, 1e-3 * on_cpu);
}

TEST_F(CudaLibrary, FindsNeighbors) {
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) {
    cloud.xyz.emplace_back(static_cast<float>(i % 10), static_cast<float>(i / 10), static_cast<float>(i * i % 7));
    cloud.rgb.push_back(Eigen::Vector3f::Constant(0.5f));
  }
  const Gaussians cpu = InitializeGaussians(cloud, {}, kCpu), gpu = InitializeGaussians(cloud, {}, kGpu);
  EXPECT_THAT(gpu.log_scales.To(kCpu).span(), testing::Pointwise(testing::FloatNear(1e-5f), cpu.log_scales.span()));
}

}  // namespace
}  // namespace oraclegs
