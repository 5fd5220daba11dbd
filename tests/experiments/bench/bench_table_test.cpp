#include "oraclegs/experiments/bench/bench_table.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "experiments/bench/bench_example.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

const Statistic& Psnr(const BenchRow& row) { return *row.value[0]; }

TEST(BenchRows, AreScenesThenMeansThenWhatIsQuoted) {
  const auto rows = BenchRows(ExampleBench());
  ASSERT_EQ(rows.size(), 4u + 2 + 10);
  EXPECT_EQ(rows[0].scene, "garden");
  EXPECT_DOUBLE_EQ(Psnr(rows[0]).mean, 20.5);
  EXPECT_NEAR(*Psnr(rows[0]).deviation, 0.7071, 1e-4);
  EXPECT_EQ(rows[3].failure, "failed: no|points");
  EXPECT_TRUE(rows[4].is_mean());
  EXPECT_DOUBLE_EQ(Psnr(rows[4]).mean, 22) << "of 21 and 23, the means of seeds 0 and 1";
  EXPECT_NEAR(*Psnr(rows[4]).deviation, 1.4142, 1e-4);
  EXPECT_EQ(rows[6].label, "Mip-NeRF 360");
  EXPECT_NE(rows[6].source, "");
}

TEST(BenchRows, ComparesWithWhatIsPublishedOfAllScenesAlone) {
  BenchReport report = ExampleBench();
  auto rows = BenchRows(report);
  ASSERT_TRUE(rows[4].published);
  EXPECT_NEAR(*DifferenceToPublished(rows[4], BenchValue::kPsnr), 22 - 20.32, 1e-9);
  EXPECT_FALSE(DifferenceToPublished(rows[4], BenchValue::kLpips)) << "not measured";
  report.runs[4].failure = report.runs[5].failure = "no";
  EXPECT_FALSE(BenchRows(report)[4].published);
  report = ExampleBench();
  report.compares = false;
  rows = BenchRows(report);
  EXPECT_EQ(rows.size(), 6u);
  EXPECT_FALSE(rows[4].published);
}

TEST(BenchRows, MarksTheBestWhereTwoCompare) {
  const auto rows = BenchRows(ExampleBench());
  EXPECT_TRUE(rows[0].best[0]) << "20.5 against 20";
  EXPECT_FALSE(rows[1].best[0]);
  EXPECT_FALSE(rows[2].best[0]) << "alone in its scene";
  EXPECT_FALSE(rows[4].best[0]) << "the other has one scene of two";
  BenchReport equal = ExampleBench();
  for (size_t r = 0; r < 4; ++r) equal.runs[r].value[0] = 20.001 + 0.001 * static_cast<double>(r % 2);
  const auto tied = BenchRows(equal);
  EXPECT_TRUE(tied[0].best[0] && tied[1].best[0]) << "printed alike";
}

TEST(BenchRows, LowerLpipsIsBetter) {
  BenchReport report = ExampleBench();
  for (size_t r = 0; r < 4; ++r) report.runs[r].value[2] = r < 2 ? 0.3 : 0.2;
  const auto rows = BenchRows(report);
  EXPECT_FALSE(rows[0].best[2]);
  EXPECT_TRUE(rows[1].best[2]);
}

TEST(BenchRows, MeansOfUnevenSeedsHaveNoDeviation) {
  BenchReport report = ExampleBench();
  report.runs[1].ended = false, report.runs[4].ended = false;  // garden has seed 0 alone, room seed 1
  const auto rows = BenchRows(report);
  EXPECT_DOUBLE_EQ(Psnr(rows[4]).mean, 22.5);
  EXPECT_FALSE(Psnr(rows[4]).deviation);
}

TEST(CountWins, CountsScenesInWhichTwoCompare) {
  const BenchWins wins = CountWins(ExampleBench(), 12);
  EXPECT_THAT(wins.wins, ElementsAre(1, 0));
  EXPECT_EQ(wins.of, 1u);
}

TEST(ScoreCell, HasTheDecimalsOfItsScore) {
  EXPECT_EQ(ScoreCell(Statistic{2, 27.006, 0.1234}, BenchValue::kPsnr), "27.01 ± 0.12");
  EXPECT_EQ(ScoreCell(Statistic{1, 0.5, std::nullopt}, BenchValue::kSsim), "0.5000");
  EXPECT_EQ(ScoreCell(std::nullopt, BenchValue::kLpips), "-");
}

}  // namespace
}  // namespace oraclegs
