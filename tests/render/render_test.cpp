#include "oraclegs/render/render.h"

#include "support/golden.h"

namespace oraclegs {
namespace {

TEST(MakeRasterizer, TheCpuIsAlwaysThere) { EXPECT_NE(MakeRasterizer(kCpu), nullptr); }

#if !defined(ORACLEGS_CUDA)
TEST(MakeRasterizer, ADeviceThatThisBuildLacksIsRefusedByName) {
  try {
    MakeRasterizer(Device(torch::kCUDA, 1));
    FAIL() << "a CPU-only build must not fall back in silence";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("cuda:1"));
  }
}
#endif

}  // namespace
}  // namespace oraclegs
