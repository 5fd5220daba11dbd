#include "oraclegs/sfm/pair_evidence.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

PairEvidence Between(int matches, int inliers, bool pure_rotation = false) {
  return {"a", "b", matches, inliers, pure_rotation};
}

TEST(PairEvidence, IsNoLinkByChance) {
  EXPECT_TRUE(Between(400, 30).IsLink());
  EXPECT_TRUE(Between(33, 17).IsLink()) << "half of few";
  EXPECT_FALSE(Between(160, 20).IsLink()) << "weak features of images that share nothing";
  EXPECT_FALSE(Between(50, 15).IsLink());
  EXPECT_FALSE(Between(12, 12).IsLink());
}

TEST(AreFromOnePoint, AsksLinksAlone) {
  EXPECT_TRUE(AreFromOnePoint({Between(500, 300, true), Between(400, 200, true), Between(90, 18, false)}));
  EXPECT_FALSE(AreFromOnePoint({Between(500, 300, true), Between(400, 200, false)}));
  EXPECT_FALSE(AreFromOnePoint({Between(90, 18, true)}));
  EXPECT_FALSE(AreFromOnePoint({}));
}

}  // namespace
}  // namespace oraclegs
