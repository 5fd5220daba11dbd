#include "oraclegs/networks/common/attention.h"

#include <cmath>

#include "networks/golden_tensors.h"

namespace oraclegs {
namespace {

/// All scores at once, in float64.
Tensor Scores(const Tensor& q, const Tensor& k) {
  const double scale = 1 / std::sqrt(static_cast<double>(q.size(-1)));
  return at::softmax(at::matmul(q.to(torch::kDouble), k.to(torch::kDouble).transpose(-1, -2)) * scale, -1);
}

TEST(Attend, MatchesTheDefinitionForAnyChunk) {
  torch::manual_seed(1);
  const Tensor q = torch::randn({2, 3, 17, 8}), k = torch::randn({2, 3, 11, 8}), v = torch::randn({2, 3, 11, 8});
  const Tensor expected = at::matmul(Scores(q, k), v.to(torch::kDouble));
  // One row, a few rows, one head at a time, several heads, all at once.
  for (const int64_t max_scores : {1, 30, 11 * 17, 3 * 11 * 17, 1 << 20, 0}) {
    EXPECT_LT(MaxAbsError(Attend(q, k, v, max_scores), expected), 1e-5) << max_scores;
  }
}

TEST(Attend, TakesViewsThatAreNotContiguous) {
  torch::manual_seed(2);
  const Tensor packed = torch::randn({1, 9, 3, 2, 4}).permute({2, 0, 3, 1, 4});
  const Tensor expected = at::matmul(Scores(packed[0], packed[1]), packed[2].to(torch::kDouble));
  EXPECT_LT(MaxAbsError(Attend(packed[0], packed[1], packed[2], 20), expected), 1e-5);
}

TEST(Attend, HalfPrecisionStaysNearFloat) {
  torch::manual_seed(3);
  const Tensor q = torch::randn({1, 2, 5, 8}), k = torch::randn({1, 2, 6, 8}), v = torch::randn({1, 2, 6, 8});
  const Tensor half = Attend(q.to(torch::kBFloat16), k.to(torch::kBFloat16), v.to(torch::kBFloat16));
  EXPECT_EQ(half.scalar_type(), torch::kBFloat16);
  EXPECT_LT(MaxAbsError(half, Attend(q, k, v)), 0.05);
}

TEST(Attend, RefusesWhatDoesNotFit) {
  const Tensor q = torch::rand({1, 2, 5, 8});
  EXPECT_THROW(Attend(q, torch::rand({1, 2, 6, 7}), torch::rand({1, 2, 6, 7})), ShapeError);
  EXPECT_THROW(Attend(q, torch::rand({1, 2, 6, 8}), torch::rand({1, 2, 5, 8})), ShapeError);
  EXPECT_THROW(Attend(q, torch::rand({1, 3, 6, 8}), torch::rand({1, 3, 6, 8})), ShapeError);
  EXPECT_THROW(Attend(q[0], q[0], q[0]), ShapeError);
}

TEST(MeanAttention, MatchesTheDefinitionForAnyChunk) {
  torch::manual_seed(4);
  const Tensor q = torch::randn({3, 17, 8}), k = torch::randn({3, 11, 8});
  const Tensor expected = Scores(q, k).mean(1).mean(0);
  for (const int64_t max_scores : {1, 30, 1 << 20, 0}) {
    EXPECT_LT(MaxAbsError(MeanAttention(q, k, max_scores), expected), 1e-7) << max_scores;
  }
  EXPECT_NEAR(MeanAttention(q, k).sum().item<double>(), 1, 1e-6);
}

TEST(MeanAttention, RefusesWhatDoesNotFit) {
  EXPECT_THROW(MeanAttention(torch::rand({3, 5, 8}), torch::rand({3, 5, 7})), ShapeError);
  EXPECT_THROW(MeanAttention(torch::rand({3, 5, 8}), torch::rand({2, 5, 8})), ShapeError);
  EXPECT_THROW(MeanAttention(torch::rand({3, 0, 8}), torch::rand({3, 5, 8})), ShapeError);
}

}  // namespace
}  // namespace oraclegs
