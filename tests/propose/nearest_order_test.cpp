#include "oraclegs/propose/nearest_order.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "propose/rigs.h"

namespace oraclegs {
namespace {

TEST(NearestOrder, OrdersLine) {
  std::vector<Camera> cameras;
  for (const int x : {4, 0, 7, 2, 6, 1, 5, 3}) {
    cameras.push_back(RigCamera({1. * x, 0, 0}, {1. * x, 9, 0}));
  }
  std::vector<double> xs;
  for (const size_t i : NearestOrder(cameras)) xs.push_back(cameras[i].Center().x());
  EXPECT_TRUE(std::is_sorted(xs.begin(), xs.end()) || std::is_sorted(xs.rbegin(), xs.rend()));
}

TEST(NearestOrder, VisitsEachCameraOnce) {
  const auto cameras = RigAround(20);
  std::vector<size_t> order = NearestOrder(cameras);
  for (size_t i = 0; i + 1 < order.size(); ++i) {
    EXPECT_LT((cameras[order[i]].Center() - cameras[order[i + 1]].Center()).norm(), 4) << i;
  }
  std::sort(order.begin(), order.end());
  for (size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
  EXPECT_EQ(order.size(), 20u);
}

TEST(NearestOrder, AcceptsOneCameraAndPureRotation) {
  EXPECT_EQ(NearestOrder(RigAround(1)), std::vector<size_t>{0});
  std::vector<Camera> turning;
  for (const double angle : {0., 0.4, 0.2, 0.6}) {
    turning.push_back(RigCamera({0, 0, 0}, {std::cos(angle), std::sin(angle), 0}));
  }
  const std::vector<size_t> order = NearestOrder(turning);
  EXPECT_TRUE(order == (std::vector<size_t>{0, 2, 1, 3}) || order == (std::vector<size_t>{3, 1, 2, 0}));
}

}  // namespace
}  // namespace oraclegs
