#include "oraclegs/gaussians/neighbors.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// Brute-force search over every pair, in double.
std::vector<double> BruteForce(const Points& points) {
  std::vector<double> out;
  for (size_t i = 0; i < points.size(); ++i) {
    std::vector<double> d2;
    for (size_t j = 0; j < points.size(); ++j) {
      if (i != j) d2.push_back((points[i].cast<double>() - points[j].cast<double>()).squaredNorm());
    }
    std::sort(d2.begin(), d2.end());
    d2.resize(std::min<size_t>(3, d2.size()));
    double sum = 0;
    for (const double d : d2) sum += d;
    out.push_back(d2.empty() ? 0 : sum / static_cast<double>(d2.size()));
  }
  return out;
}

Points Cluster(int n, uint64_t seed, float flatness) {
  Rng rng(seed, RandomStream::kInitialPoints);
  Points points;
  for (int i = 0; i < n; ++i) {
    // Dense near the origin, with a few far away, and flat: cells of very different shapes.
    const double r = std::pow(rng.Uniform(), 4) * 100;
    points.emplace_back(static_cast<float>(r * rng.Uniform(-1, 1)), static_cast<float>(r * rng.Uniform(-1, 1)),
                        flatness * static_cast<float>(rng.Uniform(-1, 1)));
  }
  return points;
}

void ExpectExact(const Points& points) {
  const std::vector<double> expected = BruteForce(points), actual = KdTree(points).MeanSquaredDistanceToThree();
  ASSERT_EQ(actual.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-14 * expected[i]) << i;
}

TEST(KdTree, AgreesWithEveryPair) {
  for (const int n : {0, 1, 2, 3, 4, 5, 12, 13, 24, 25, 26, 100, 1000}) ExpectExact(Cluster(n, n, 1.f));
  ExpectExact(Cluster(700, 5, 0.f));
  ExpectExact(Cluster(700, 6, 1e4f));
}

TEST(KdTree, DuplicatesAreAtDistanceZero) {
  Points same(500, Eigen::Vector3f(1, 2, 3));
  for (const double d : KdTree(same).MeanSquaredDistanceToThree()) EXPECT_EQ(d, 0);
  Points pairs = Cluster(300, 7, 1.f);
  pairs.insert(pairs.end(), pairs.begin(), pairs.begin() + 150);
  ExpectExact(pairs);
}

TEST(KdTree, GridHasUnitNeighbors) {
  Points grid;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      for (int z = 0; z < 10; ++z) grid.emplace_back(x, y, z);
    }
  }
  for (const double d : KdTree(grid).MeanSquaredDistanceToThree()) EXPECT_EQ(d, 1);
}

TEST(KdTree, NamesTheThreeNearest) {
  for (const int n : {1, 2, 3, 4, 30, 1000}) {
    const Points points = Cluster(n, n, 1.f);
    const auto nearest = KdTree(points).ThreeNearest();
    const std::vector<double> expected = BruteForce(points);
    ASSERT_EQ(nearest.size(), points.size());
    for (size_t i = 0; i < nearest.size(); ++i) {
      double sum = 0;
      int64_t found = 0;
      for (const NearPoint& near : nearest[i]) {
        if (near.index < 0) continue;
        ++found;
        sum += near.squared_distance;
        EXPECT_NE(near.index, static_cast<int64_t>(i));
        EXPECT_DOUBLE_EQ(near.squared_distance,
                         (points[near.index].cast<double>() - points[i].cast<double>()).squaredNorm());
      }
      EXPECT_EQ(found, std::min(3, n - 1));
      EXPECT_NEAR(found == 0 ? 0 : sum / static_cast<double>(found), expected[i], 1e-14 * expected[i]);
      EXPECT_TRUE(std::is_sorted(nearest[i].begin(), nearest[i].end(), [](const NearPoint& a, const NearPoint& b) {
        return a.squared_distance < b.squared_distance;
      }));
    }
  }
}

TEST(KdTree, HasWithinIncludesTheRadius) {
  const KdTree tree({{1, 2, 3}, {4, 2, 3}});
  EXPECT_TRUE(tree.HasWithin({1, 2, 3}, 0));
  EXPECT_TRUE(tree.HasWithin({1, 0, 3}, 2));
  EXPECT_FALSE(tree.HasWithin({1, 0, 3}, 1.9999));
  EXPECT_FALSE(KdTree({}).HasWithin({1, 0, 3}, 100));
  const Points points = Cluster(2000, 3, 1.f), queries = Cluster(500, 4, 1.f);
  const KdTree many(points);
  for (const Eigen::Vector3f& query : queries) {
    double nearest = 1e30;
    for (const Eigen::Vector3f& p : points) {
      nearest = std::min(nearest, (p.cast<double>() - query.cast<double>()).norm());
    }
    EXPECT_TRUE(many.HasWithin(query, nearest * 1.000001));
    EXPECT_FALSE(many.HasWithin(query, nearest * 0.999999));
  }
}

TEST(KdTree, SameBitsForAnyNumberOfThreads) {
  const Points points = Cluster(20000, 9, 1.f);
  SetNumThreads(1);
  const std::vector<double> one = KdTree(points).MeanSquaredDistanceToThree();
  SetNumThreads(3);
  EXPECT_EQ(KdTree(points).MeanSquaredDistanceToThree(), one);
  SetNumThreads(0);
}

}  // namespace
}  // namespace oraclegs
