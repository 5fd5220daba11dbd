#include "bench/gpu_table.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace oraclegs {
namespace {

using testing::HasSubstr;

GpuReport Report() {
  GpuReport report;
  report.work = {1000, 600, 3000, 40000, 50000, 10000};
  report.times.project = 0.5, report.times.blend = 2, report.times.iteration = 4;
  report.ceilings = {1e9, 1e9};
  report.training_bytes = 1234, report.scratch_bytes = 567;
  return report;
}

TEST(FloorMilliseconds, IsTheLargerOfMemoryAndArithmetic) {
  const GpuCeilings ceilings{1e9, 1e6};
  EXPECT_DOUBLE_EQ(FloorMilliseconds({"", 0, 3e6, 0}, ceilings), 3);
  EXPECT_DOUBLE_EQ(FloorMilliseconds({"", 0, 3e6, 5e3}, ceilings), 5);
  EXPECT_DOUBLE_EQ(FloorMilliseconds({"", 0, 0, 0}, ceilings), 0);
  EXPECT_DOUBLE_EQ(FloorMilliseconds({"", 0, 3e6, 5e3}, {}), 0);  // nothing was measured
}

TEST(GpuStages, CountTheLeastTraffic) {
  const GpuReport report = Report();
  const std::vector<GpuStage> stages = GpuStages(report.work, report.times);
  EXPECT_EQ(stages[1].name, "project");
  EXPECT_DOUBLE_EQ(stages[1].bytes, 1000 * 52 + 600 * 240);
  EXPECT_EQ(stages[6].name, "Gaussians, Adam, noise");
  EXPECT_DOUBLE_EQ(stages[6].bytes, 1000 * 1416 + 3000 * 40);  // three times 236 bytes, read and written
}

TEST(GpuStages, EndWithTheSums) {
  const GpuReport report = Report();
  const std::vector<GpuStage> stages = GpuStages(report.work, report.times);
  ASSERT_EQ(stages.size(), 9u);
  double bytes = 0, flops = 0;
  for (size_t i = 0; i < 7; ++i) bytes += stages[i].bytes, flops += stages[i].flops;
  EXPECT_DOUBLE_EQ(stages[7].bytes, stages[1].bytes + stages[2].bytes + stages[3].bytes);
  EXPECT_DOUBLE_EQ(stages[8].bytes, bytes);
  EXPECT_DOUBLE_EQ(stages[8].flops, flops);
  EXPECT_EQ(stages[8].ms, 4);
}

TEST(GpuTable, ShowsTimesFloorsAndMemory) {
  const std::string text = GpuTable(Report());
  EXPECT_THAT(text, HasSubstr("1000 Gaussians, 600 visible, 3000 pairs, 10000 pixels; 1 GB/s, 0.0 TFLOP/s"));
  EXPECT_THAT(text, HasSubstr("1234 bytes a Gaussian in training, 567 of them the rasterizer's"));
  EXPECT_THAT(text, HasSubstr("project                      0.500     0.196     0.000     39%"));
  EXPECT_THAT(text, HasSubstr("blend                        2.000     0.396     0.840     42%"));
  EXPECT_THAT(text, HasSubstr("loss                         0.000     0.270     0.000      0%"));  // not measured
}

TEST(GpuReportToJson, HoldsTheFigures) {
  const nlohmann::json json = GpuReportToJson(Report());
  EXPECT_EQ(json.at("iteration_ms"), 4);
  EXPECT_EQ(json.at("training_bytes_per_gaussian"), 1234);
  EXPECT_NEAR(json.at("stages").at("project").at("floor_ms").get<double>(), 0.196, 1e-9);
}

}  // namespace
}  // namespace oraclegs
