#include "oraclegs/networks/seva/maps.h"

#include "networks/fixtures.h"

namespace oraclegs::seva {
namespace {

TEST(SevaMaps, VectorsAreForAllPixels) {
  const auto map = [](float first) {
    return (first + at::arange(12).to(torch::kFloat)).view({1, 2, 2, 3}).contiguous(at::MemoryFormat::ChannelsLast);
  };
  const Tensor x = map(1), added = map(30), vector = torch::tensor({1.f, 2.f}), wide = vector.view({1, 2, 1, 1});
  EXPECT_TRUE(torch::equal(SumOfMaps(x, added, vector), x + added + wide));
  EXPECT_TRUE(torch::equal(SumOfMaps(x, {}, vector), x + wide));
  EXPECT_TRUE(HasChannelsLast(SumOfMaps(x, added, vector)));
}

TEST(SevaMaps, ConvolutionsKeepTheirBias) {
  RandomParameters source(2);
  const Conv conv = LoadConv(ParameterScope(source), {4, 6});
  const Tensor x = at::sin(at::arange(2 * 4 * 5 * 5).to(torch::kFloat)).view({2, 4, 5, 5});
  EXPECT_TRUE(torch::equal(ConvolveMap(conv, x), Forward(conv, x)));
  EXPECT_LE(MaxAbsError(Forward(WithoutBias(conv), x) + conv.bias.view({1, 6, 1, 1}), Forward(conv, x)), 1e-6);
  EXPECT_TRUE(conv.bias.defined());
}

}  // namespace
}  // namespace oraclegs::seva
