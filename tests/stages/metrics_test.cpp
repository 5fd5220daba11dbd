#include "oraclegs/stages/metrics.h"

#include "run/fixtures.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(MetricsToJson, HasTheKeysThatOthersRelyOn) {
  const TempDir temp;
  auto run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), Silent());
  run.workspace.MarkDone(
      "sfm",
      {{"key", "a"}, {"seconds", 3}, {"cpu_seconds", 5}, {"points", 400}, {"poses", {{"warning", "poses are off"}}}});
  run.workspace.MarkDone("validate", {{"key", "v"},
                                      {"seconds", 1},
                                      {"oracle", "vggt"},
                                      {"mean_confidence", {{"a", 0.5}, {"b", 1}}},
                                      {"non_commercial", {"VGGT-1B"}}});
  run.workspace.MarkDone("depth", {{"key", "c"},
                                   {"warning", "little depth"},
                                   {"seconds", 4},
                                   {"points", 9000},
                                   {"prior", "fused"},
                                   {"right", 0.7},
                                   {"network", "a"}});
  run.workspace.MarkDone("start", {{"key", ""}, {"seconds", 0}, {"source", "dense"}, {"points", 500}});
  run.workspace.MarkDone("train", {{"key", "b"},
                                   {"seconds", 12},
                                   {"training_seconds", 10},
                                   {"iterations", 50},
                                   {"chosen", {{"rate-scale", 3.5}}},
                                   {"lpips", "VGG16"},
                                   {"peak_memory_bytes", int64_t{1} << 50}});
  const nlohmann::json test = {{"psnr", 20.5}, {"ssim", 0.7}, {"views", nlohmann::json::array()}};
  const nlohmann::json metrics =
      MetricsToJson(run, {{"test", test}, {"gaussians", 500}, {"seconds", 1.5}, {"peak_memory_bytes", 7}});
  EXPECT_EQ(metrics.at("test"), test);
  EXPECT_EQ(metrics.at("gaussians"), 500);
  EXPECT_EQ(metrics.at("stages").at("sfm").at("seconds"), 3);
  EXPECT_EQ(metrics.at("stages").at("sfm").at("cpu_seconds"), 5);
  EXPECT_FALSE(metrics.at("stages").at("depth").contains("cpu_seconds"));
  EXPECT_EQ(metrics.at("stages").at("depth").at("seconds"), 4);
  EXPECT_EQ(metrics.at("stages").at("train").at("seconds"), 12);
  EXPECT_EQ(metrics.at("stages").at("evaluate").at("seconds"), 1.5);
  EXPECT_FALSE(metrics.at("stages").contains("register"));
  EXPECT_EQ(metrics.at("train").at("iterations"), 50);
  EXPECT_EQ(metrics.at("train").at("iterations_per_second"), 5);
  EXPECT_EQ(metrics.at("train").at("lpips"), "VGG16");
  EXPECT_EQ(metrics.at("train").at("chosen").at("rate-scale"), 3.5);
  EXPECT_EQ(metrics.at("depth").at("prior"), "fused");
  EXPECT_EQ(metrics.at("depth").at("right"), 0.7);
  EXPECT_EQ(metrics.at("depth").at("network"), "a");
  EXPECT_EQ(metrics.at("proposals").at("oracle"), "vggt");
  EXPECT_EQ(metrics.at("proposals").at("count"), 2);
  EXPECT_EQ(metrics.at("proposals").at("mean_confidence"), 0.75);
  EXPECT_EQ(metrics.at("peak_memory_bytes"), int64_t{1} << 50);
  EXPECT_EQ(metrics.at("warnings"), nlohmann::json({"poses are off", "little depth"}));
  EXPECT_EQ(metrics.at("non_commercial"), nlohmann::json({"VGGT-1B"}));
  EXPECT_EQ(metrics.at("program"), "oraclegs");
  EXPECT_EQ(metrics.at("version"), "test");
  EXPECT_EQ(metrics.at("seed"), 0);
  EXPECT_EQ(metrics.at("options").at("iterations"), 30);
  EXPECT_EQ(metrics.at("start").at("source"), "dense");
  EXPECT_EQ(metrics.at("start").at("points"), 500);
  EXPECT_EQ(metrics.at("views").at("train"), 4);
}

TEST(CpuSeconds, GrowWithWork) {
  const double before = CpuSeconds();
  EXPECT_GT(before, 0);
  volatile double sum = 0;
  while (CpuSeconds() < before + 0.05) sum = sum + 1;
  EXPECT_GE(CpuSeconds(), before + 0.05);
}

TEST(ReadMetrics, NamesADamagedFile) {
  const TempDir temp;
  EXPECT_THROW(ReadMetrics(temp.path()), InputError);
  WriteText(temp / "metrics.json", "{\"test\":");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadMetrics(temp.path()); }), testing::HasSubstr("metrics.json"));
}

}  // namespace
}  // namespace oraclegs
