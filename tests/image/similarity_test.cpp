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

TEST(SquaredErrorOf, InvertsSimilarity) {
  for (const float error : {0.01f, 0.08f, 0.2f}) EXPECT_NEAR(SquaredErrorOf(Similarity(error)), error * error, 1e-6f);
}

}  // namespace
}  // namespace oraclegs
