#include "oraclegs/train/densify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace oraclegs {
namespace {

TrainOptions ToHundred() {
  TrainOptions options;
  options.iterations = 100;
  options.refine_start = 30, options.refine_every = 10, options.refine_stop = 0.7;
  return options;
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
  TrainOptions options = ToHundred();
  const auto refines = [&](int i) { return Refines(options, i); };
  EXPECT_THAT(Iterations(refines), testing::ElementsAre(40, 50, 60));
  options.refine_stop = 1;
  EXPECT_THAT(Iterations(refines), testing::ElementsAre(40, 50, 60, 70, 80, 90)) << "never after the last one";
}

TEST(IsBeforeRefineStop, EndsWithTheLastIteration) {
  TrainOptions options = ToHundred();
  const auto before = [&](int i) { return IsBeforeRefineStop(options, i); };
  EXPECT_EQ(Iterations(before).back(), 69);
  options.refine_stop = 1;
  EXPECT_EQ(Iterations(before).back(), 99);
}

}  // namespace
}  // namespace oraclegs
