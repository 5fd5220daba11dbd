#include "oraclegs/experiments/layer_sweep.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/line_chart.h"
#include "oraclegs/experiments/series.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/stages/metrics.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr char kSweepRun[] = "run", kSweepJson[] = "layers.json", kSweepMarkdown[] = "layers.md",
               kSweepSvg[] = "layers.svg";
const std::vector<std::string> kLayerColumns = {"layer", "AUROC, error above the median", "AUROC, error above 0.1",
                                                "AUSE of random", "Spearman"};

void RequireSweepable(const RunOptions& options) {
  if (!options.validate.vggt_layers.empty()) {
    throw UsageError("--each-layer chooses --set vggt-layers itself; leave it out");
  }
  const Auto<OracleKind>& oracle = options.validate.oracle;
  if (!oracle.is_auto() && oracle.value() != OracleKind::kVggt) {
    throw UsageError("--each-layer measures --oracle vggt; leave out --oracle {}", Word(oracle.value()));
  }
}

RunRequest RequestOf(const RunRequest& request, std::optional<int64_t> layer) {
  RunRequest run = request;
  run.out = request.out / kSweepRun;
  run.options.propose.proposal_size = ProposalSize::kView;  // which the images have
  run.options.trajectory.trajectory = Trajectory::kDataset;
  run.options.validate.oracle = OracleKind::kVggt;
  run.options.validate.calibrate = false;
  if (layer) run.options.validate.vggt_layers = std::to_string(*layer);
  return run;
}

std::optional<double> MeasuredIn(const json& quality, const char* name) {
  const json& value = quality.at(name);
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

LayerQuality QualityOf(std::optional<int64_t> layer, const json& oracle) {
  return {layer, MeasuredIn(oracle, "auroc_above_median"), MeasuredIn(oracle, "auroc_large_error"),
          MeasuredIn(oracle, "ause_ratio"), oracle.at("spearman").get<double>()};
}

void Write(const fs::path& out, const LayerSweep& sweep) {
  WriteFileAtomically(out / kSweepJson,
                      LayerSweepToJson(sweep).dump(2, ' ', false, json::error_handler_t::replace) + "\n");
  WriteFileAtomically(out / kSweepMarkdown, LayerSweepMarkdown(sweep));
  WriteFileAtomically(out / kSweepSvg, LayerSweepPlot(sweep));
}

std::string NameOf(const LayerQuality& quality) {
  return quality.layer ? std::to_string(*quality.layer) : "as combined";
}

std::vector<std::string> Cells(const LayerQuality& quality) {
  const auto text = [](const std::optional<double>& value) { return value ? fmt::format("{:.3f}", *value) : "-"; };
  return {NameOf(quality), text(quality.auroc_above_median), text(quality.auroc_large_error), text(quality.ause_ratio),
          text(quality.spearman)};
}

std::string ProtocolOf(const LayerSweep& sweep) {
  return fmt::format("{}, {}, {} with an image at their pose", sweep.network,
                     Counted(sweep.train_views, "training view"), Counted(sweep.views, "proposal"));
}

}  // namespace

LayerSweep RunLayerSweep(const RunRequest& request, const std::string& command, const Listener& listener) {
  RequireSweepable(request.options);
  const fs::path& out = request.out;
  RequireOutsideScene(out, request.scene);
  RequireSeriesFolder(out, {"sweep of layers", kSweepJson, {kSweepRun, kSweepJson, kSweepMarkdown, kSweepSvg}});
  LayerSweep sweep;
  sweep.scene = request.scene.string(), sweep.command = command, sweep.version = request.version;
  SeriesListener events(listener);
  int64_t layers = 0;
  for (int64_t i = 0; i <= layers; ++i) {
    ThrowIfInterrupted();
    const std::optional<int64_t> layer = i > 0 ? std::optional(i - 1) : std::nullopt;
    oraclegs::Run run = StartRun(RequestOf(request, layer),
                                 events.ForRun(layer ? fmt::format("layer {}: ", *layer) : "layers as combined: "));
    RunStage(&run, "validate");
    const json report = ReportOracle(run);
    layers = run.plan.oracle.weights->layers, sweep.network = run.plan.oracle.weights->name;
    sweep.train_views = run.split.train.size(), sweep.views = report.at("views").get<int64_t>();
    sweep.layers.push_back(QualityOf(layer, report.at("oracle")));
    Write(out, sweep);
  }
  for (const char* file : {kSweepJson, kSweepMarkdown, kSweepSvg}) listener(FileWritten{out / file});
  return sweep;
}

json LayerSweepToJson(const LayerSweep& sweep) {
  const auto number = [](const auto& value) { return value ? json(*value) : json(); };
  json layers = json::array();
  for (const LayerQuality& quality : sweep.layers) {
    layers.push_back({{"layer", number(quality.layer)},
                      {"auroc_above_median", number(quality.auroc_above_median)},
                      {"auroc_large_error", number(quality.auroc_large_error)},
                      {"ause_ratio", number(quality.ause_ratio)},
                      {"spearman", quality.spearman}});
  }
  return {{"program", "oraclegs"},      {"version", sweep.version},
          {"command", sweep.command},   {"scene", sweep.scene},
          {"network", sweep.network},   {"views", {{"train", sweep.train_views}, {"proposals", sweep.views}}},
          {"layers", std::move(layers)}};
}

std::string LayerSweepText(const LayerSweep& sweep) {
  std::vector<std::vector<std::string>> rows = {kLayerColumns};
  for (const LayerQuality& quality : sweep.layers) rows.push_back(Cells(quality));
  return ProtocolOf(sweep) + "\n" + AlignColumns(rows, "lrrrr");
}

std::string LayerSweepMarkdown(const LayerSweep& sweep) {
  std::string text = fmt::format(
      "# Layers of the oracle on {}\n\n{}; oraclegs {}.\n\n    {}\n\n![AUROC of each layer](layers.svg)\n\n| {} |\n| "
      "--- | --- | --- | --- | --- |\n",
      sweep.scene, ProtocolOf(sweep), sweep.version, sweep.command, fmt::join(kLayerColumns, " | "));
  for (const LayerQuality& quality : sweep.layers) text += fmt::format("| {} |\n", fmt::join(Cells(quality), " | "));
  return text +
         "\n"
         "- AUROC: of low attention as a sign of an error above the median, and above 0.1; 0.5 is chance.\n"
         "- AUSE of random: area under the sparsification error curve by that of a random order; 0 is the ideal "
         "order.\n"
         "- Spearman: rank correlation of attention and −error.\n"
         "- as combined: the layers and weights that `--oracle vggt` uses by itself; in the plot their first AUROC.\n";
}

std::string LayerSweepPlot(const LayerSweep& sweep) {
  constexpr double kPercent = 100;
  LineChart chart{.x_title = "layer of VGGT's global attention", .y_title = "AUROC, %"};
  ChartLine median{"above median", ChartColor(0), {}}, large{"above 0.1", ChartColor(1), {}};
  ChartLine combined{"as combined", ChartColor(2), {}};
  const auto last = static_cast<double>(sweep.layers.size()) - 2;
  chart.x_high = std::max(1.0, last);
  for (const LayerQuality& quality : sweep.layers) {
    if (!quality.layer) {
      if (!quality.auroc_above_median) continue;
      const double y = kPercent * *quality.auroc_above_median;
      combined.points = {{0, y}, {chart.x_high, y}};
      continue;
    }
    const auto x = static_cast<double>(*quality.layer);
    chart.ticks.push_back({x, std::to_string(*quality.layer)});
    if (quality.auroc_above_median) median.points.push_back({x, kPercent * *quality.auroc_above_median});
    if (quality.auroc_large_error) large.points.push_back({x, kPercent * *quality.auroc_large_error});
  }
  chart.lines = {std::move(median), std::move(large), std::move(combined)};
  return ChartSvg(chart);
}

}  // namespace oraclegs
