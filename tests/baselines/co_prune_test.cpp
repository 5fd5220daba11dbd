#include "oraclegs/baselines/co_prune.h"

#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

Gaussians WithCenters(const std::vector<std::array<float, 3>>& centers) {
  Gaussians g = RandomGaussians(static_cast<int64_t>(centers.size()), 1);
  std::copy(&centers[0][0], &centers[0][0] + 3 * centers.size(), g.means.data());
  return g;
}

TEST(CoPruneKeep, KeepsWhatTheOtherModelHas) {
  const Gaussians model = WithCenters({{0, 0, 0}, {5, 0, 0}, {5.001f, 0, 0}, {100, 103, 104}, {100, 103, 105}});
  const Gaussians other = WithCenters({{0, 0, 0}, {100, 100, 100}});
  EXPECT_EQ(CoPruneKeep(model, other, 5), (std::vector<uint8_t>{1, 1, 0, 1, 0}));
  EXPECT_EQ(CoPruneKeep(model, other, 6), (std::vector<uint8_t>{1, 1, 1, 1, 1}));
  EXPECT_EQ(CoPruneKeep(model, other, 0), (std::vector<uint8_t>{1, 0, 0, 0, 0}));
  EXPECT_EQ(CoPruneKeep(other, model, 5), (std::vector<uint8_t>{1, 1}));
}

TEST(CoPruneKeep, AgreesWithEveryPairForAnyNumberOfThreads) {
  const Gaussians a = RandomGaussians(3000, 1), b = RandomGaussians(2000, 2);
  std::vector<uint8_t> expected;
  for (int64_t i = 0; i < a.size(); ++i) {
    const Eigen::RowVector3d center = Table(a.means).row(i).matrix().cast<double>();
    const auto others = Table(b.means).matrix().cast<double>();
    expected.push_back((others.rowwise() - center).rowwise().norm().minCoeff() <= 0.3);
  }
  for (const int threads : {1, 3}) {
    const Threads scope(threads);
    EXPECT_EQ(CoPruneKeep(a, b, 0.3), expected);
  }
  EXPECT_GT(std::count(expected.begin(), expected.end(), 0), 100);
  EXPECT_GT(std::count(expected.begin(), expected.end(), 1), 100);
}

TEST(CoPruneKeep, TakesEmptyModels) {
  const Gaussians none = Gaussians::Empty(0), some = RandomGaussians(3, 1);
  EXPECT_TRUE(CoPruneKeep(none, some, 5).empty());
  EXPECT_EQ(CoPruneKeep(some, none, 5), (std::vector<uint8_t>{0, 0, 0}));
}

}  // namespace
}  // namespace oraclegs
