#include "oraclegs/networks/common/autocast.h"

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

torch::ScalarType TypeOfAProduct() { return at::mm(at::ones({2, 2}), at::ones({2, 2})).scalar_type(); }

TEST(Autocast, TurnsProductsIntoHalfAsLongAsItLives) {
  EXPECT_EQ(TypeOfAProduct(), torch::kFloat);
  {
    const Autocast mixed(torch::kCPU, torch::kBFloat16);
    EXPECT_EQ(TypeOfAProduct(), torch::kBFloat16);
    EXPECT_EQ(at::ones({2}).add(1).scalar_type(), torch::kFloat) << "sums stay as they are";
    {
      const Autocast exact(torch::kCPU, std::nullopt);
      EXPECT_EQ(TypeOfAProduct(), torch::kFloat);
    }
    EXPECT_EQ(TypeOfAProduct(), torch::kBFloat16);
  }
  EXPECT_EQ(TypeOfAProduct(), torch::kFloat);
}

TEST(HalfTypeOf, IsWhatTheDeviceIsFastAt) {
  EXPECT_EQ(HalfTypeOf(torch::kCPU), torch::kBFloat16);
  EXPECT_EQ(HalfTypeOf(torch::kCUDA), torch::kHalf);
}

}  // namespace
}  // namespace oraclegs
