#include "oraclegs/train/schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "oraclegs/train/densify.h"
#include "oraclegs/train/options.h"
#include "support/golden.h"

namespace oraclegs {
namespace {

constexpr double kTolerance = 1e-6;  // relative

TEST(Schedule, RatesComeToRestInTheSecondHalf) {
  EXPECT_EQ(RateFactor(1, 1000, 0.1), 1);
  EXPECT_EQ(RateFactor(500, 1000, 0.1), 1);
  EXPECT_NEAR(RateFactor(750, 1000, 0.1), std::sqrt(0.1), 1e-9);
  EXPECT_NEAR(RateFactor(1000, 1000, 0.1), 0.1, 1e-9);
}

TEST(ScheduleTest, MatchesGolden) {
  const SafetensorsFile golden = OpenGolden("schedule");
  const auto t = golden.Values<double>("t");
  const auto iteration = golden.Values<int64_t>("iteration");
  const double extent = golden.Values<double>("spatial_extent").at(0);
  const auto expect = [&](const char* name, const std::function<double(int64_t, int64_t)>& f) {
    const auto wanted = golden.Values<double>(name);
    ASSERT_EQ(wanted.size(), t.size());
    for (size_t k = 0; k < t.size(); ++k) {
      // The run's length follows from t; where t is 0 any does.
      const int64_t iterations = t[k] > 0 ? std::llround(static_cast<double>(iteration[k]) / t[k]) : 30000;
      EXPECT_NEAR(f(iteration[k], iterations), wanted[k], kTolerance * std::abs(wanted[k])) << name << " " << t[k];
    }
  };
  expect("p_synthetic", [](int64_t i, int64_t n) { return SyntheticProbability(i, n); });
  expect("p_photograph", [](int64_t i, int64_t n) { return 1 - SyntheticProbability(i, n); });
  expect("depth_weight", DepthWeight);
  expect("lr_xyz", [&](int64_t i, int64_t n) { return MeansLearningRate(i, n, extent); });
  expect("active_sh_degree", [](int64_t i, int64_t) { return ActiveShDegree(i); });
}

TEST(ScheduleTest, ShDegreeRisesAtMultiplesOfTheInterval) {
  EXPECT_EQ(ActiveShDegree(1), 0);
  EXPECT_EQ(ActiveShDegree(999), 0);
  EXPECT_EQ(ActiveShDegree(1000), 1);
  EXPECT_EQ(ActiveShDegree(2999), 2);
  EXPECT_EQ(ActiveShDegree(3000), 3);
  EXPECT_EQ(ActiveShDegree(1000000), 3);
  EXPECT_EQ(ActiveShDegree(20, 10), 2);
}

TEST(ScheduleTest, LearningRateEndsAreExactAndStayThere) {
  EXPECT_DOUBLE_EQ(MeansLearningRate(0, 100, 2), 3.2e-4);
  EXPECT_DOUBLE_EQ(MeansLearningRate(50, 100, 1), 1.6e-5);
  EXPECT_DOUBLE_EQ(MeansLearningRate(100, 100, 1), 1.6e-6);
  EXPECT_DOUBLE_EQ(MeansLearningRate(200, 100, 1), 1.6e-6);
}

TEST(ScheduleTest, ProposalsAreLikeliestAtAQuarter) {
  const double peak = SyntheticProbability(250, 1000);
  EXPECT_NEAR(peak, 0.20547, 1e-5);
  for (int64_t i = 0; i <= 1000; ++i) {
    EXPECT_LE(SyntheticProbability(i, 1000), peak);
    EXPECT_DOUBLE_EQ(SyntheticProbability(i, 1000, {0.3, 0}), 0.3);
  }
}

TEST(ScheduleTest, ProposalsHaveAFloorAndAPeakAndStayAProbability) {
  EXPECT_DOUBLE_EQ(SyntheticProbability(0, 1000, {0.3, 2}), 0.3);
  EXPECT_DOUBLE_EQ(SyntheticProbability(500, 1000, {0.3, 2}), 0.3 + 2.0 / 16);
  EXPECT_DOUBLE_EQ(SyntheticProbability(250, 1000, {0.3, 50}), 1);
  EXPECT_DOUBLE_EQ(SyntheticProbability(1000, 1000, {0, 50}), 0);
}

TEST(ScheduleTest, OptionsChooseWhatIsDrawn) {
  TrainOptions options;
  EXPECT_NEAR(SyntheticProbability(250, 1000, options.Proposals()), 0.20547, 1e-5);
  options.synthetic_floor = 0.2;
  options.synthetic_peak = 3;
  EXPECT_DOUBLE_EQ(SyntheticProbability(500, 1000, options.Proposals()), 0.2 + 3.0 / 16);
  options.schedule = ScheduleKind::kConstant;
  EXPECT_DOUBLE_EQ(SyntheticProbability(500, 1000, options.Proposals()), 0.2);
  options.schedule = ScheduleKind::kFalling;
  EXPECT_DOUBLE_EQ(SyntheticProbability(1, 1000, options.Proposals()), 0.2);
  EXPECT_DOUBLE_EQ(SyntheticProbability(500, 1000, options.Proposals()), 0.2);
  EXPECT_DOUBLE_EQ(SyntheticProbability(750, 1000, options.Proposals()), 0.1);
  EXPECT_DOUBLE_EQ(SyntheticProbability(1000, 1000, options.Proposals()), 0);
  EXPECT_DOUBLE_EQ(SyntheticProbability(1200, 1000, options.Proposals()), 0) << "trained on behind the horizon";
  options.schedule = ScheduleKind::kNone;
  EXPECT_DOUBLE_EQ(SyntheticProbability(500, 1000, options.Proposals()), 0);
}

TEST(ScheduleTest, ExposureRateFallsTenfold) {
  EXPECT_NEAR(ExposureLearningRate(0, 1000), 1e-2, 1e-9);
  EXPECT_NEAR(ExposureLearningRate(500, 1000), std::sqrt(1e-5), 1e-9);
  EXPECT_NEAR(ExposureLearningRate(1000, 1000), 1e-3, 1e-9);
}

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
  const auto refines = [&](int i) { return options.Refines(i); };
  EXPECT_THAT(Iterations(refines), testing::ElementsAre(40, 50, 60));
  options.refine_stop = 1;
  EXPECT_THAT(Iterations(refines), testing::ElementsAre(40, 50, 60, 70, 80, 90)) << "never after the last one";
}

TEST(IsBeforeRefineStop, EndsWithTheLastIteration) {
  TrainOptions options = ToHundred();
  const auto before = [&](int i) { return options.IsBeforeRefineStop(i); };
  EXPECT_EQ(Iterations(before).back(), 69);
  options.refine_stop = 1;
  EXPECT_EQ(Iterations(before).back(), 99);
}

}  // namespace
}  // namespace oraclegs
