#include "oraclegs/stages/metrics.h"

#include <sys/resource.h>

#include <algorithm>

#include "oraclegs/core/files.h"
#include "oraclegs/core/unique_json.h"
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
  const nlohmann::json sfm = run.workspace.Record("sfm"), depth = run.workspace.Record("depth");
  if (sfm.is_object() && sfm.contains("poses") && sfm["poses"].is_object()) {
    warnings.push_back(sfm["poses"].value("warning", ""));
  }
  if (depth.is_object()) warnings.push_back(depth.value("warning", ""));
  std::erase(warnings, "");
  return warnings;
}

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
  if (evaluate_record.contains("support")) metrics["support"] = evaluate_record.at("support");
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

}  // namespace oraclegs
