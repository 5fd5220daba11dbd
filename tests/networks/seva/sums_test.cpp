#include "oraclegs/networks/seva/sums.h"

#include "networks/fixtures.h"

namespace oraclegs::seva {
namespace {

const LayerNorm kTwoWide{torch::tensor({2.f, 1.f}), torch::tensor({0.f, 5.f}), 0};

TEST(SevaSums, EachVectorizForAsManyAdjacentRows) {
  const Tensor x = torch::zeros({2, 2, 2}), rows = torch::arange(8).to(torch::kFloat);
  const Tensor vectors = torch::tensor({10.f, 20.f, 30.f, 40.f}).view({2, 1, 2});
  const Tensor expected = torch::tensor({10.f, 21.f, 12.f, 23.f, 34.f, 45.f, 36.f, 47.f}).view({2, 2, 2});
  EXPECT_TRUE(torch::equal(Sum(x, {rows, vectors}), expected));
  EXPECT_TRUE(torch::equal(Sum(x, {{}, torch::tensor({3.f, 4.f})}).sum(1), torch::tensor({6.f, 8.f}).expand({2, 2})));
  EXPECT_TRUE(torch::equal(Sum(x, {}), x));
  EXPECT_TRUE(torch::equal(x, torch::zeros({2, 2, 2})));  // a new tensor each time
  Tensor changed = x.clone();
  Add({rows, vectors}, &changed);
  EXPECT_TRUE(torch::equal(changed, expected));
  EXPECT_TRUE(torch::equal(Sum(x.transpose(0, 1), {rows, vectors}), expected));  // however x lies in memory
}

TEST(SevaSums, NormsAreOfTheSum) {
  const Tensor x = torch::tensor({1.f, 2.f}).view({1, 2}), added = torch::tensor({6.f, 1.f}).view({1, 2});
  // 7 and 3: mean 5, deviation 2.
  const Tensor normed = torch::tensor({2.f, 4.f}).view({1, 2}), sum = torch::tensor({7.f, 3.f}).view({1, 2});
  Tensor out;
  EXPECT_LE(MaxAbsError(NormOfSum(x, {added, {}}, kTwoWide, &out), normed), 1e-6);
  EXPECT_TRUE(torch::equal(out, sum));
  Tensor changed = x.clone();
  EXPECT_LE(MaxAbsError(NormAfterAdding({added, {}}, kTwoWide, &changed), normed), 1e-6);
  EXPECT_TRUE(torch::equal(changed, sum));
}

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
