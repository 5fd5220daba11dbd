#include "oraclegs/stages/metrics.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/evaluate/block_quality.h"
#include "oraclegs/evaluate/evaluate.h"
#include "oraclegs/evaluate/metrics.h"
#include "oraclegs/evaluate/oracle_quality.h"
#include "oraclegs/evaluate/sparsification.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/propose/proposal_files.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/stage_works.h"
#include "oraclegs/workspace/non_commercial.h"

namespace oraclegs {
namespace {

double PerSecond(const nlohmann::json& record) {
  const double seconds = record.value("training_seconds", 0.0);
  return seconds > 0 ? record.value("iterations", 0.0) / seconds : 0;
}

/// Warnings of stages about the input from which the whole result suffers.
std::vector<std::string> InputWarnings(const Run& run) {
  std::vector<std::string> warnings;
  const nlohmann::json sfm = run.workspace.Record("sfm"), depth = run.workspace.Record("depth"),
                       poses = run.workspace.Record("poses");
  const bool mended = poses.is_object() && poses.value("result", "") == "refined";
  if (!mended && sfm.is_object() && sfm.contains("poses") && sfm["poses"].is_object()) {
    warnings.push_back(sfm["poses"].value("warning", ""));
  }
  if (depth.is_object()) warnings.push_back(depth.value("warning", ""));
  if (poses.is_object()) warnings.push_back(poses.value("warning", ""));
  std::erase(warnings, "");
  return warnings;
}

/// Proposals whose images exist, all together.
struct MeasuredProposals {
  std::vector<float> errors, confidence;  ///< values of the pixels that count
  BlockSamples blocks, uniform_blocks;
  double psnr = 0;  ///< sum over the views
  std::vector<PixelErrors> of_views;
  std::vector<std::vector<float>> doubts;
  int views = 0;

  /// Compares the proposal at a view's pose with its image; another exposure is no error. Throws InputError for files
  /// of another size.
  void Add(const Run& run, int v) {
    const std::string name = FileName(run.scene.views[static_cast<size_t>(v)].name) + ".png";
    const auto image = run.workspace.proposals() / name, map = run.workspace.confidence() / name;
    const LoadedView truth = LoadViews(run.scene, {v}, run.plan.image, run.listener).front();
    const ImageF proposal = ToFloat(ReadImage(image)), trust = ToFloat(ReadImage(map));
    if (proposal.data.size() != truth.rgb.data.size() || trust.data.size() != truth.rgb.data.size()) {
      throw InputError("{}: is not of its view's size; delete it and run `oraclegs validate` again", image.string());
    }
    const size_t pixels = truth.rgb.data.size() / 3;
    RenderOutput drawn;
    drawn.image = ToBuffer(proposal);
    drawn.alpha = Buffer<float>::Full({truth.rgb.height, truth.rgb.width}, 1.f);
    PixelErrors found = ErrorsOf(drawn, truth);
    if (found.at.empty()) return;
    ErrorMap of_view{truth.rgb.width, truth.rgb.height, std::vector<float>(pixels), std::vector<float>(pixels),
                     std::vector<bool>(pixels)};
    std::vector<float> doubt;
    double squares = 0;
    for (size_t k = 0; k < found.at.size(); ++k) {
      const auto i = static_cast<size_t>(found.at[k]);
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        const float d = proposal.data[c] - truth.rgb.data[c];
        squares += static_cast<double>(d) * static_cast<double>(d);
      }
      of_view.error[i] = found.error[k];
      of_view.confidence[i] = trust.data[3 * i];
      of_view.counts[i] = true;
      errors.push_back(found.error[k]);
      confidence.push_back(trust.data[3 * i]);
      doubt.push_back(1 - trust.data[3 * i]);
    }
    psnr -= 10 * std::log10(squares / (3 * static_cast<double>(found.at.size())));
    of_views.push_back(std::move(found));
    doubts.push_back(std::move(doubt));
    blocks.Add(of_view);
    of_view.confidence.assign(of_view.confidence.size(), 1.f);
    uniform_blocks.Add(of_view);
    ++views;
  }

  nlohmann::json Quality(const BlockSamples& of_blocks, const std::vector<float>& of_pixels) const {
    nlohmann::json quality = ToJson(OracleQuality::FromPixels(errors, of_pixels));
    quality["blocks"] = ToJson(of_blocks.Quality());
    return quality;
  }
};

}  // namespace

double CpuSeconds() {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  double sum = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    sum += seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return sum;
}

nlohmann::json MetricsToJson(const Run& run, const nlohmann::json& evaluate_record) {
  nlohmann::json metrics;
  metrics["test"] = evaluate_record.at("test");
  if (evaluate_record.contains("train_views")) metrics["train_views"] = evaluate_record.at("train_views");
  for (const char* part : {"support", "uncertainty"}) {
    if (evaluate_record.contains(part)) metrics[part] = evaluate_record.at(part);
  }
  metrics["gaussians"] = evaluate_record.at("gaussians");
  metrics["stages"]["evaluate"]["seconds"] = evaluate_record.at("seconds");
  for (const Stage& stage : *run.stages) {
    const nlohmann::json record = run.workspace.Record(stage.name);
    if (record.is_object()) metrics["stages"][stage.name]["seconds"] = record.value("seconds", 0.0);
    if (record.contains("cpu_seconds")) metrics["stages"][stage.name]["cpu_seconds"] = record.at("cpu_seconds");
    if (stage.name == "evaluate") break;  // the report tells of an earlier result
  }
  const nlohmann::json train = run.workspace.Record("train"), start = run.workspace.Record("start");
  int64_t peak = evaluate_record.at("peak_memory_bytes").get<int64_t>();
  if (train.is_object()) {
    metrics["train"] = {{"iterations", train.value("iterations", int64_t{0})},
                        {"iterations_per_second", PerSecond(train)},
                        {"seconds", train.value("training_seconds", 0.0)},
                        {"lpips", train.value("lpips", nlohmann::json())},
                        {"chosen", train.value("chosen", nlohmann::json::object())},
                        {"milliseconds_per_iteration", train.value("milliseconds_per_iteration", nlohmann::json())}};
    peak = std::max(peak, train.value("peak_memory_bytes", int64_t{0}));
  }
  const nlohmann::json depth = run.workspace.Record("depth");
  if (depth.is_object() && depth.contains("prior")) {
    metrics["depth"] = {{"prior", depth.at("prior")},
                        {"right", depth.value("right", 0.0)},
                        {"network", depth.value("network", nlohmann::json())}};
  }
  if (const nlohmann::json poses = run.workspace.Record("poses"); poses.is_object()) {
    for (const char* name : {"result", "before", "after", "views"}) {
      if (poses.contains(name)) metrics["poses"][name] = poses.at(name);
    }
  }
  const nlohmann::json validate = run.workspace.Record("validate");
  if (validate.is_object() && validate.contains("oracle")) {
    const nlohmann::json trust = validate.value("mean_confidence", nlohmann::json::object());
    double sum = 0;
    for (const auto& mean : trust) sum += mean.get<double>();
    metrics["proposals"] = {
        {"count", trust.size()}, {"oracle", validate.at("oracle")}, {"mean_confidence", nlohmann::json()}};
    if (!trust.empty()) metrics["proposals"]["mean_confidence"] = sum / static_cast<double>(trust.size());
  }
  if (start.is_object()) {
    metrics["start"] = {{"source", start.value("source", "")}, {"points", start.value("points", int64_t{0})}};
  }
  metrics["peak_memory_bytes"] = peak;
  metrics["views"] = {{"train", run.split.train.size()}, {"test", run.split.test.size()}};
  metrics["frame"] = {
      {"level", run.frame.is_level},
      {"up", run.frame.is_level ? nlohmann::json("-y") : nlohmann::json()},
      {"unit_meters", run.frame.unit_meters ? nlohmann::json(*run.frame.unit_meters) : nlohmann::json()}};
  metrics["warnings"] = InputWarnings(run);
  metrics["non_commercial"] = NonCommercialParts(run.workspace);
  metrics["program"] = "oraclegs";
  metrics["version"] = run.version;
  metrics["options"] = RunOptionsToJson(run.options);
  metrics["seed"] = run.options.start.seed;
  return metrics;
}

nlohmann::json ReadMetrics(const std::filesystem::path& workspace) {
  const auto path = WorkspacePaths(workspace).metrics();
  nlohmann::json json = ParseJsonOrDiscard(ReadFile(path));
  if (!json.is_object()) {
    throw InputError("{}: not valid JSON; delete it and run `oraclegs evaluate`", path.string());
  }
  return json;
}

using nlohmann::json;

std::string StageTable(const std::vector<Stage>& stages, const json& before, const json& after) {
  std::vector<std::vector<std::string>> lines = {{"stage", "time", "predicted", "result"}};
  double total = 0, kept = 0, predicted_total = 0;
  bool any_predicted = false, all_predicted = true;
  for (const Stage& stage : stages) {
    if (!after.contains(stage.name) || !after[stage.name].is_object()) continue;
    const json& record = after[stage.name];
    const double seconds = record.value("seconds", 0.0), predicted = record.value("predicted_seconds", 0.0);
    const bool unchanged = before.contains(stage.name) && before[stage.name] == record;
    lines.push_back({stage.name, FormatSeconds(seconds), predicted > 0 ? FormatSeconds(predicted) : "",
                     stage.work.summary(record) + (unchanged ? " (unchanged)" : "")});
    total += seconds, predicted_total += predicted;
    kept += unchanged ? seconds : 0;
    any_predicted = any_predicted || predicted > 0;
    all_predicted = all_predicted && predicted > 0;
  }
  lines.push_back({"total", FormatSeconds(total), all_predicted ? FormatSeconds(predicted_total) : "",
                   kept > 0 ? fmt::format("{} in this run", FormatSeconds(total - kept)) : ""});
  if (any_predicted) return AlignColumns(lines, "lrrl");
  for (auto& line : lines) line.erase(line.begin() + 2);
  return AlignColumns(lines, "lrl");
}

nlohmann::json ReportOracle(const Run& run) {
  const nlohmann::json record = run.workspace.Record("validate");
  const nlohmann::json validated =
      record.is_object() ? record.value("mean_confidence", nlohmann::json::object()) : nlohmann::json::object();
  MeasuredProposals measured;
  for (const int v : SpareViews(run)) {
    if (validated.contains(FileName(run.scene.views[static_cast<size_t>(v)].name))) measured.Add(run, v);
  }
  if (validated.empty()) {
    throw InputError(
        "{}: holds no validated proposals; run `oraclegs validate` with --trajectory dataset and --views N below the "
        "number of photos",
        run.workspace.root().string());
  }
  if (measured.views == 0) {
    throw InputError(
        "{}: no proposal has the pose of a view that neither trains nor tests; only --trajectory dataset "
        "with --views N below the number of photos can be measured",
        run.workspace.root().string());
  }
  nlohmann::json oracle = measured.Quality(measured.blocks, measured.confidence);
  oracle["published_ause"] = {{"pooled", ToJson(PooledAuse(measured.of_views, measured.doubts))},
                              {"images", ToJson(MeanAuse(measured.of_views, measured.doubts))}};
  nlohmann::json report = {
      {"views", measured.views},
      {"psnr", measured.psnr / measured.views},
      {"oracle", std::move(oracle)},
      {"uniform", measured.Quality(measured.uniform_blocks, std::vector<float>(measured.errors.size(), 1.f))}};
  WriteFileAtomically(run.workspace.root() / "oracle.json", report.dump(2) + "\n");
  return report;
}

}  // namespace oraclegs
