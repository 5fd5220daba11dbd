#include "oraclegs/propose/trajectory.h"

#include <gtest/gtest.h>

#include "oraclegs/core/parallel.h"
#include "propose/rigs.h"

namespace oraclegs {
namespace {

Camera OnCircle(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return RigCamera({4 * std::cos(a), 4 * std::sin(a), 0}, {0, 0, 0});
}

TEST(ChooseByCoverage, PrefersUnseenDirections) {
  const auto points = SpherePoints(4000, 1);
  const std::vector<Camera> train = {OnCircle(0), OnCircle(40)};
  const std::vector<Camera> candidates = {OnCircle(20), OnCircle(2), OnCircle(180), OnCircle(185), OnCircle(41)};
  const auto chosen = ChooseByCoverage(points, train, candidates, 3);
  ASSERT_EQ(chosen.size(), 3u);
  EXPECT_TRUE(chosen[0] == 2 || chosen[0] == 3);  // the side that no view shows
  EXPECT_EQ(chosen[1], 0u);                       // then not that side once more
}

TEST(ChooseByCoverage, GivesSameResultForAnyThreads) {
  const auto points = SpherePoints(2000, 1);
  std::vector<Camera> candidates;
  for (int i = 0; i < 60; ++i) candidates.push_back(OnCircle(6.1 * i));
  std::vector<std::vector<size_t>> results;
  for (const int threads : {1, 3}) {
    SetNumThreads(threads);
    results.push_back(ChooseByCoverage(points, RigAround(5), candidates, 20));
  }
  SetNumThreads(0);
  EXPECT_EQ(results[0].size(), 20u);
  EXPECT_EQ(results[0], results[1]);
}

/// Greedy choice that judges every candidate anew each time; the lazy choice must equal it.
TEST(ChooseByCoverage, IsGreedy) {
  const auto points = SpherePoints(1500, 1);
  std::vector<Camera> train = RigAround(3), candidates;
  for (int i = 0; i < 24; ++i) candidates.push_back(OnCircle(15. * i + i % 4));
  const auto chosen = ChooseByCoverage(points, train, candidates, 6);
  ASSERT_EQ(chosen.size(), 6u);
  for (const size_t next : chosen) {
    EXPECT_EQ(ChooseByCoverage(points, train, candidates, 1), std::vector<size_t>{next});
    train.push_back(candidates[next]);
  }
}

TEST(ChooseByCoverage, StopsWithoutGain) {
  const auto points = SpherePoints(500, 1);
  const std::vector<Camera> candidates = {OnCircle(0), RigCamera({4, 0, 0}, {9, 0, 0})};  // seen already; sees nothing
  EXPECT_EQ(ChooseByCoverage(points, {}, candidates, 5), std::vector<size_t>{0});
  EXPECT_TRUE(ChooseByCoverage(points, {OnCircle(0)}, {}, 5).empty());
}

TEST(Openness, IsTheNewnessOfPhotos) {
  const auto points = SpherePoints(4000, 1);
  EXPECT_EQ(Openness(points, {OnCircle(0)}), 1);
  EXPECT_EQ(Openness(points, {}), 1);
  EXPECT_EQ(Openness({}, RigAround(5)), 1);
  double before = 1;
  for (const double step : {30., 10., 3., 1.}) {
    std::vector<Camera> train;
    for (double angle = 0; angle < 360; angle += step) train.push_back(OnCircle(angle));
    const double open = Openness(points, train);
    EXPECT_LT(open, before) << step;
    EXPECT_NEAR(open, 1 - std::exp(-step / 10), 0.15) << step;
    before = open;
  }
}

}  // namespace
}  // namespace oraclegs
