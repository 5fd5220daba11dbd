#include "oraclegs/image/similarity.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(Similarity, FallsWithError) {
  EXPECT_EQ(Similarity(0.f), 1.f);
  EXPECT_NEAR(Similarity(kSimilarityScale), std::exp(-1), 1e-15);
  EXPECT_LT(Similarity(0.3f), 1e-5f);
  EXPECT_NEAR(Similarity(0.02, 0.02), std::exp(-1), 1e-15);
}

TEST(ExpectedSimilarity, IsTheMeanOverHalfNormalErrors) {
  EXPECT_EQ(ExpectedSimilarity(0), 1);
  for (const double mean : {0.01, 0.05, 0.2}) {
    const double sigma = mean * std::sqrt(std::numbers::pi / 2), step = sigma / 1000;
    double similarity = 0, total = 0;
    for (double error = step / 2; error < 8 * sigma; error += step) {
      const double density = std::exp(-error * error / (2 * sigma * sigma));
      similarity += density * Similarity(error), total += density;
    }
    EXPECT_NEAR(ExpectedSimilarity(static_cast<float>(mean)), similarity / total, 1e-4) << mean;
  }
}

TEST(SquaredErrorOf, InvertsSimilarity) {
  for (const float error : {0.01f, 0.08f, 0.2f}) EXPECT_NEAR(SquaredErrorOf(Similarity(error)), error * error, 1e-6f);
}

}  // namespace
}  // namespace oraclegs
