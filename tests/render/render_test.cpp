#include "oraclegs/render/render.h"
#include "oraclegs/core/config.h"

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

#if !defined(ORACLEGS_CUDA)
TEST(MakeRasterizer, NamesADeviceThatThisBuildLacks) {
  EXPECT_THAT(
      [] {
        MakeRasterizer({DeviceKind::kCuda, 1});
      },
      testing::ThrowsMessage<UsageError>(testing::HasSubstr("cuda:1")));
}
#endif

}  // namespace

}  // namespace oraclegs
