#include "oraclegs/render/make_rasterizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/config.h"

namespace oraclegs {
namespace {

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
