#include "oraclegs/networks/seva/norms.h"

#include "networks/fixtures.h"

namespace oraclegs::seva {
namespace {

GroupNorm RandomNorm(int64_t channels, int64_t groups, double eps) {
  RandomParameters source(3);
  return LoadGroupNorm(ParameterScope(source), channels, groups, eps);
}

TEST(GroupNorm, EachGroupOfEachImageHasMeanZeroAndVarianceOne) {
  GroupNorm norm = RandomNorm(6, 3, 0);
  norm.weight = torch::ones({6});
  norm.bias = torch::zeros({6});
  const Tensor y = Forward(norm, 5 + 3 * torch::rand({2, 6, 7, 4})).view({2, 3, -1}).to(torch::kDouble);
  EXPECT_LT(y.mean(-1).abs().max().item<double>(), 1e-5);
  EXPECT_LT((y.square().mean(-1) - 1).abs().max().item<double>(), 1e-4);
}

TEST(GroupNorm, EpsilonIsAddedToTheVariance) {
  const GroupNorm norm = RandomNorm(2, 1, 0.75);
  // Values -a and a: variance a^2 = 1/4, and 1/4 + 3/4 = 1.
  const Tensor x = torch::tensor({-0.5f, 0.5f}).view({1, 2, 1, 1});
  const Tensor expected = x * norm.weight.view({1, 2, 1, 1}) + norm.bias.view({1, 2, 1, 1});
  EXPECT_LT(MaxAbsError(Forward(norm, x), expected), 1e-6);
}

TEST(GroupNorm, SiluFollowsOnRequest) {
  const GroupNorm norm = RandomNorm(8, 2, 1e-5);
  const Tensor x = torch::rand({1, 8, 3, 5}), y = Forward(norm, x);
  EXPECT_LT(MaxAbsError(NormThenSilu(norm, x), y / (1 + (-y).exp())), 1e-6);
}

TEST(GroupNorm, ComputesInFloatWhateverTheType) {
  GroupNorm norm = RandomNorm(4, 2, 1e-6);
  // Steps of 2 among values that fill 40: a mean or a square in this type would be far off.
  const Tensor x = (300 + 40 * torch::rand({1, 4, 16, 16})).to(torch::kBFloat16);
  const Tensor expected = Forward(norm, x.to(torch::kFloat));
  norm.weight = norm.weight.to(torch::kBFloat16);
  norm.bias = norm.bias.to(torch::kBFloat16);
  const Tensor y = Forward(norm, x);
  EXPECT_EQ(y.scalar_type(), torch::kBFloat16);
  EXPECT_LT(RelativeL2(y, expected), 0.01);
  EXPECT_EQ(NormThenSilu(norm, x).scalar_type(), torch::kBFloat16);
}

TEST(GroupNorm, ChannelsLastStayLastAndChangeNothing) {
  const GroupNorm norm = RandomNorm(12, 3, 1e-5);
  GroupNorm norm_last = norm;
  norm_last.channels_last = true;
  const Tensor x = 2 + torch::rand({2, 12, 5, 7});
  for (const auto type : {torch::kFloat, torch::kBFloat16}) {
    const Tensor last = x.to(type).contiguous(at::MemoryFormat::ChannelsLast), y = Forward(norm_last, last);
    EXPECT_TRUE(HasChannelsLast(y));
    EXPECT_EQ(y.scalar_type(), type);
    EXPECT_LT(RelativeL2(y, Forward(norm, x.to(type))), type == torch::kFloat ? 1e-5 : 0.02);
    EXPECT_TRUE(HasChannelsLast(NormThenSilu(norm_last, last)));
  }
}

TEST(GroupNorm, GroupsMustDivideTheChannels) {
  EXPECT_THAT([] { RandomNorm(6, 4, 1e-5); },
              testing::ThrowsMessage<ShapeError>("LoadGroupNorm: 4 groups do not divide 6 channels"));
  EXPECT_THROW(RandomNorm(6, 0, 1e-5), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva
