#include "oraclegs/validate/isotonic.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(Isotonic, IsTheIdentityBeforeItHasLearned) {
  EXPECT_EQ(Isotonic()(0.3f), 0.3f);
  EXPECT_EQ(Isotonic::Fit({})(0.7f), 0.7f);
}

TEST(Isotonic, PoolsWhatFalls) {
  // By hand: 1 and 0 at x = 2, 3 pool to 0.5.
  const Isotonic map = Isotonic::Fit({{3.f, 0.f}, {1.f, 0.f}, {2.f, 1.f}, {4.f, 1.f}});
  EXPECT_FLOAT_EQ(map(1.f), 0.f);
  EXPECT_FLOAT_EQ(map(2.5f), 0.5f);
  EXPECT_FLOAT_EQ(map(4.f), 1.f);
  EXPECT_FLOAT_EQ(map(9.f), 1.f);
  EXPECT_FLOAT_EQ(map(-9.f), 0.f);
  EXPECT_FLOAT_EQ(map(1.75f), 0.25f);  // between the middles of two steps
}

TEST(Isotonic, NeverFalls) {
  std::vector<std::pair<float, float>> samples;
  for (int i = 0; i < 5000; ++i) {
    const float x = static_cast<float>(i * 7919 % 5000) / 5000;
    samples.emplace_back(x, x * x + (i % 2 == 0 ? 0.3f : -0.3f));
  }
  const Isotonic map = Isotonic::Fit(samples);
  float before = -1;
  for (int i = 0; i <= 100; ++i) {
    const float y = map(static_cast<float>(i) / 100);
    EXPECT_GE(y, before);
    before = y;
  }
  EXPECT_NEAR(map(0.5f), 0.25f, 0.05f);
}

TEST(Isotonic, TakesOneLevelForOneConfidence) {
  const Isotonic map = Isotonic::Fit({{0.5f, 0.f}, {0.5f, 1.f}, {0.5f, 0.5f}});
  EXPECT_FLOAT_EQ(map(0.1f), 0.5f);
  EXPECT_FLOAT_EQ(map(0.9f), 0.5f);
}

}  // namespace
}  // namespace oraclegs
