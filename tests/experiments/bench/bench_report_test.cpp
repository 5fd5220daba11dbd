#include "oraclegs/experiments/bench/bench_report.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "experiments/bench/bench_example.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(BenchText, HasARowForEachSceneAndMethod) {
  const std::string text = BenchText(ExampleBench());
  EXPECT_THAT(text, HasSubstr("Mip-NeRF 360, 12 training views, seeds 0, 1\n"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "\ngarden          OracleGS      20.50 ± 0.71  0.4100 ± 0.0141      -  3:25      6:50  2.0 GB       1000\n"));
  EXPECT_THAT(text, HasSubstr("\nroom            3DGS-MCMC     failed: no|points\n"));
  EXPECT_THAT(text, HasSubstr("20.32 / 0.596 / 0.350  +1.68 / -0.156 / -"));
  EXPECT_THAT(text, HasSubstr("mean of 1 of 2  3DGS-MCMC"));
  EXPECT_THAT(text, HasSubstr("Best PSNR of a scene: OracleGS in 1 of 1, 3DGS-MCMC in 0\n"));
  EXPECT_THAT(text, HasSubstr("quoted: as printed in [Topaloglu 2026]"));
}

TEST(BenchMarkdown, HasExactCells) {
  const std::string text = BenchMarkdown(ExampleBench());
  EXPECT_THAT(
      text, HasSubstr("# Benchmark on Mip-NeRF 360\n\nseeds 0, 1; oraclegs 1.0 (abc).\n\n    oraclegs bench -o a_b\n"));
  EXPECT_THAT(
      text,
      HasSubstr("| garden | OracleGS | **20.50 ± 0.71** | **0.4100 ± 0.0141** | - | 3:25 | 6:50 | 2.0 GB | 1000 | "
                " |  |\n"));
  EXPECT_THAT(text, HasSubstr("| room | 3DGS-MCMC | failed: no\\|points | | | | | | | | |\n"));
  EXPECT_THAT(
      text, HasSubstr("| mean | OracleGS | 22.00 ± 1.41 | 0.4400 ± 0.0283 | - | 3:40 | 7:20 | 2.0 GB | 1000 | 20.32 / "
                      "0.596 / 0.350 | +1.68 / -0.156 / - |\n"));
  EXPECT_THAT(text, HasSubstr("| quoted | 3DGS | 18.52 | 0.523 | 0.415 | - | - | - | - |  |  |\n"));
  EXPECT_THAT(text, HasSubstr("![Test PSNR over the number of training views](bench-views.svg)"));
  EXPECT_THAT(text, HasSubstr("- 3DGS-MCMC: [Kheradmand 2024], run here.\n"));
}

TEST(BenchMarkdown, NamesFailuresBesideScores) {
  BenchReport report = ExampleBench();
  report.runs[1].failure = "out of memory";
  report.notes = {"A note."};
  EXPECT_THAT(
      BenchMarkdown(report),
      AllOf(HasSubstr("- garden, 12 training views, paper, seed 1 failed: out of memory\n"), HasSubstr("- A note.\n")));
  report.compares = false;
  EXPECT_THAT(BenchMarkdown(report), Not(HasSubstr("published")));
}

TEST(BenchLatex, EscapesAndMarksTheBest) {
  BenchReport report = ExampleBench();
  report.scenes[0] = "my_garden", report.methods[0].label = "a & b";
  for (BenchScore& run : report.runs) {
    if (run.scene == "garden") run.scene = "my_garden";
  }
  const std::string text = BenchLatex(report);
  EXPECT_THAT(text, HasSubstr("\\midrule\nmy\\_garden & a \\& b & \\textbf{20.50 $\\pm$ 0.71} & \\textbf{0.4100 $\\pm$ "
                              "0.0141} & - & 3:25 & 6:50 & 2.0 GB & 1000 \\\\\n"));
  EXPECT_THAT(text, HasSubstr("room & 3DGS-MCMC & \\multicolumn{7}{l}{failed: no|points} \\\\\n"));
  EXPECT_THAT(text,
              HasSubstr("& published & \\multicolumn{7}{l}{20.32 / 0.596 / 0.350; difference +1.68 / -0.156 / -}"));
  EXPECT_THAT(text, HasSubstr("\\bottomrule\n\\end{tabular}\n"));
}

TEST(BenchToJson, HasRunsAndRows) {
  const json report = BenchToJson(ExampleBench());
  EXPECT_EQ(report.at("program"), "oraclegs");
  EXPECT_EQ(report.at("runs").size(), 8u);
  EXPECT_EQ(report.at("runs").at(0).at("psnr"), 20);
  EXPECT_EQ(report.at("runs").at(0).at("lpips"), nullptr);
  EXPECT_EQ(report.at("runs").at(6).at("failure"), "no|points");
  EXPECT_EQ(report.at("runs").at(7).at("ended"), false);
  const json& mean = report.at("rows").at(4);
  EXPECT_EQ(mean.at("scene"), nullptr);
  EXPECT_EQ(mean.at("psnr").at("mean"), 22);
  EXPECT_EQ(mean.at("published").at("psnr"), 20.32);
  EXPECT_NEAR(mean.at("difference").at("psnr").get<double>(), 1.68, 1e-9);
  EXPECT_EQ(report.at("rows").at(6).at("source").get<std::string>().substr(0, 16), "[Topaloglu 2026]");
}

TEST(BenchCsv, HasALineForEachRow) {
  BenchReport report = ExampleBench();
  report.runs[6].failure = "a \"b\", c";
  report.runs[0].version = report.runs[1].version = "1.0 (abc)", report.runs[2].version = "0.9 (old)";
  const std::string text = BenchCsv(report);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 16);
  EXPECT_THAT(text, HasSubstr("suite,views,scene,method,scored,of,psnr,psnr_deviation,ssim,"));
  EXPECT_THAT(
      text,
      HasSubstr("\nmipnerf360,12,garden,paper,2,2,20.5,0.707106781,0.41,0.0141421356,,,205,7.07106781,410,14.1421356,"
                "2e+09,0,1000,0,,,,,,,,1.0 (abc),\n"));
  EXPECT_THAT(text, HasSubstr(",0.9 (old); test,\n")) << "of runs of an earlier call";
  EXPECT_THAT(text, HasSubstr(",1.0 (abc); test,\n")) << "a mean of both scenes";
  EXPECT_THAT(text, HasSubstr(",\"failed: a \"\"b\"\", c\"\n"));
}

}  // namespace
}  // namespace oraclegs
