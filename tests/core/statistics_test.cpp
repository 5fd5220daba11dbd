#include "oraclegs/core/statistics.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(UpperMedian, IsMiddleOfOddCount) { EXPECT_EQ(UpperMedian(std::vector<double>{9, 1, 4}), 4); }

TEST(UpperMedian, IsUpperOfEvenCount) {
  std::vector<float> values = {7, 1, 5, 3};
  EXPECT_EQ(UpperMedian(&values), 5.f);
}

TEST(Median, IsMeanOfMiddleTwo) {
  EXPECT_EQ(Median(std::vector<double>{7, 1, 5, 3}), 4);
  EXPECT_EQ(Median(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(Median(std::vector<double>{6}), 6);
}

TEST(Median, IsZeroOfNone) {
  EXPECT_EQ(Median(std::vector<double>()), 0);
  EXPECT_EQ(UpperMedian(std::vector<float>()), 0.f);
}

TEST(Sigmoid, IsInverseOfLogit) {
  EXPECT_EQ(Sigmoid(0.), 0.5);
  for (const double p : {0.01, 0.3, 0.99}) EXPECT_NEAR(Sigmoid(std::log(p / (1 - p))), p, 1e-15);
  EXPECT_EQ(Sigmoid(-1e4f), 0.f);
  EXPECT_EQ(Sigmoid(1e4f), 1.f);
}

}  // namespace
}  // namespace oraclegs
