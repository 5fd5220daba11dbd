#include "oraclegs/train/refine_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace oraclegs {
namespace {

TrainOptions Settled() {
  TrainOptions options;
  options.iterations = 100;
  options.refine_start = 30, options.refine_every = 10, options.refine_stop = 0.7;
  options.baseline.densify = Densify::kAdaptive;
  options.baseline.opacity_reset = 25;
  return options.Settled();
}

template <class F>
std::vector<int> Iterations(const F& holds) {
  std::vector<int> iterations;
  for (int i = 1; i <= 110; ++i) {
    if (holds(i)) iterations.push_back(i);
  }
  return iterations;
}

TEST(Refines, BetweenStartAndStop) {
  TrainOptions options = Settled();
  const auto refines = [&](int i) { return Refines(options, i); };
  EXPECT_THAT(Iterations(refines), testing::ElementsAre(40, 50, 60));
  options.refine_stop = 1;
  EXPECT_THAT(Iterations(refines), testing::ElementsAre(40, 50, 60, 70, 80, 90)) << "never after the last one";
}

TEST(ResetsOpacities, OfAdaptiveDensityAlone) {
  TrainOptions options = Settled();
  const auto black = [&](int i) { return ResetsOpacities(options, false, i); };
  const auto white = [&](int i) { return ResetsOpacities(options, true, i); };
  EXPECT_THAT(Iterations(black), testing::ElementsAre(25, 50));
  EXPECT_THAT(Iterations(white), testing::ElementsAre(25, 30, 50));
  options.baseline.opacity_reset_first = 6;
  EXPECT_THAT(Iterations(white), testing::ElementsAre(6, 31, 56));
  options.baseline.opacity_reset = 0;
  EXPECT_TRUE(Iterations(white).empty());
  options = Settled();
  options.baseline.densify = Densify::kMcmc;
  EXPECT_TRUE(Iterations(black).empty());
}

}  // namespace
}  // namespace oraclegs
