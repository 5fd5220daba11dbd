#include "oraclegs/experiments/layer_sweep.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run/proposing.h"
#include "support/errors.h"
#include "support/network_files.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

LayerSweep TwoLayers() {
  LayerSweep sweep;
  sweep.scene = "garden", sweep.command = "oraclegs ablate garden", sweep.version = "1", sweep.network = "VGGT-1B";
  sweep.train_views = 12, sweep.views = 97;
  sweep.layers = {{{}, 0.7, 0.8, 0.5, 0.25}, {0, 0.6, 0.65, 0.75, 0.125}, {1, 0.5, std::nullopt, std::nullopt, -0.5}};
  return sweep;
}

TEST(LayerSweep, IsATableWithALineForEachLayer) {
  const LayerSweep sweep = TwoLayers();
  EXPECT_THAT(LayerSweepText(sweep),
              HasSubstr("VGGT-1B, 12 training views, 97 proposals with an image at their pose\n"));
  EXPECT_THAT(LayerSweepText(sweep), HasSubstr("\nas combined                          0.700  "));
  const std::string document = LayerSweepMarkdown(sweep);
  EXPECT_THAT(document, HasSubstr("| as combined | 0.700 | 0.800 | 0.500 | 0.250 |\n| 0 | 0.600 "));
  EXPECT_THAT(document, HasSubstr("| 1 | 0.500 | - | - | -0.500 |\n"));
  const nlohmann::json report = LayerSweepToJson(sweep);
  EXPECT_EQ(report["layers"][0]["layer"], nullptr);
  EXPECT_EQ(report["layers"][1]["auroc_above_median"], 0.6);
  EXPECT_EQ(report["layers"][2]["ause_ratio"], nullptr);
}

TEST(LayerSweep, IsAPlotWithALineForTheCombination) {
  const std::string plot = LayerSweepPlot(TwoLayers());
  for (const char* name : {">above median<", ">above 0.1<", ">as combined<"}) EXPECT_THAT(plot, HasSubstr(name));
  LayerSweep one = TwoLayers();
  one.layers.resize(1);
  EXPECT_THAT(LayerSweepPlot(one), Not(HasSubstr(">above median<"))) << "no layer is measured yet";
}

using LayerSweepRunTest = ProposingTest;

TEST_F(LayerSweepRunTest, MeasuresEachLayerOfTheNetwork) {
  SKIP_WITHOUT_NETWORKS();
  RunRequest request = Request("sweep");
  request.options.propose.proposers = std::string("warp");
  request.options.validate.oracle = {};
  request.options.weights.vggt_weights = WriteTinyVggt(*temp / "vggt.safetensors");
  const LayerSweep sweep = RunLayerSweep(request, "oraclegs validate", Silent());
  ASSERT_GE(sweep.layers.size(), 3u);
  EXPECT_FALSE(sweep.layers[0].layer);
  EXPECT_EQ(sweep.layers.back().layer, static_cast<int64_t>(sweep.layers.size()) - 2);
  EXPECT_NE(sweep.layers[1].spearman, sweep.layers[2].spearman);
  EXPECT_EQ(sweep.views, 8);
  for (const char* file : {"layers.json", "layers.md", "layers.svg"}) {
    EXPECT_TRUE(fs::exists(request.out / file)) << file;
  }
}

TEST_F(LayerSweepRunTest, RefusesWhatItChoosesItself) {
  RunRequest request = Request("refused");
  request.options.validate.vggt_layers = "0";
  const auto refusal = [&] { return MessageOf<UsageError>([&] { RunLayerSweep(request, "", Silent()); }); };
  EXPECT_THAT(refusal(), HasSubstr("--set vggt-layers"));
  request.options.validate.vggt_layers = "", request.options.validate.oracle = OracleKind::kUniform;
  EXPECT_THAT(refusal(), HasSubstr("--oracle"));
  EXPECT_FALSE(fs::exists(request.out));
}

}  // namespace
}  // namespace oraclegs
