#include "oraclegs/stages/stage_seconds.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

class StageSeconds : public testing::Test {
 protected:
  SceneSize scene{12, {4000, 3000}};
  RunOptions options = WithSize({}, scene, {false});
  EstimateInput input{options, scene, 14, 2, 0, 1, false};
};

TEST_F(StageSeconds, CountPixels) {
  EXPECT_EQ(FullPixels(input), 12e6);
  EXPECT_EQ(PixelsOfView(input), 1000 * 750);
  input.covered = 0.5;
  EXPECT_EQ(CoveredPixels(input), 500 * 750);
}

TEST_F(StageSeconds, GrowWithTheWork) {
  EXPECT_GT(SecondsOfFeatures(input, 24), 2 * SecondsOfFeatures(input, 12)) << "pairs grow faster than photos";
  EXPECT_NEAR(SecondsOfScores(input, 20), 2 * SecondsOfScores(input, 10), 1e-9);
  const double iteration = SecondsOfIteration(input), render = SecondsOfRender(input);
  options.train.max_gaussians = 2 * options.train.max_gaussians.value();
  EXPECT_GT(SecondsOfIteration(input), iteration);
  EXPECT_GT(SecondsOfRender(input), render);
}

TEST_F(StageSeconds, ProposalsAreNoneWithoutProposers) {
  EXPECT_GT(ProposalsOf(input), 0);
  options.propose.proposers = std::string("none");
  EXPECT_EQ(ProposalsOf(input), 0);
}

}  // namespace
}  // namespace oraclegs
