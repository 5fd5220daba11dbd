#include "oraclegs/render/render.h"
#include "oraclegs/core/cuda_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace oraclegs {
namespace {

class NoConsumer final : public GradientConsumer {};

TEST(GradientConsumer, ThrowsOnAnotherDevice) {
  NoConsumer consumer;
  EXPECT_THAT([&] { consumer.ConsumeBlock(0, 1, {}); },
              testing::ThrowsMessage<ShapeError>(testing::HasSubstr("on a CPU")));
}

TEST(MakeRasterizer, AlwaysHasOneForTheCpu) { EXPECT_NE(MakeRasterizer(kCpu), nullptr); }

TEST(MakeRasterizer, NeedsTheLibraryOfDeviceCodeForAGpu) {
  if (HasCudaLibrary()) GTEST_SKIP() << "which this build has";
  EXPECT_THAT(
      [] {
        MakeRasterizer({DeviceKind::kCuda, 1});
      },
      testing::ThrowsMessage<UsageError>(testing::HasSubstr("liboraclegs_cuda.so, which is not here")));
}

}  // namespace

}  // namespace oraclegs
