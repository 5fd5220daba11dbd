#include "oraclegs/workspace/stage_table.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "oraclegs/core/plural.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

using nlohmann::json;

int64_t Count(const json& record, const char* what) { return record.value(what, int64_t{0}); }

std::string Proposed(const json& record) {
  std::string text = Counted(Count(record, "targets"), "view");
  if (Count(record, "folder") > 0) text += fmt::format(", {} from the folder", Count(record, "folder"));
  if (Count(record, "proxy_models") > 0) text += ", " + Counted(Count(record, "proxy_models"), "proxy model");
  return text;
}

std::string Validated(const json& record) {
  const json means = record.value("mean_confidence", json::object());
  if (means.empty()) return "0 proposals";
  double sum = 0;
  for (const json& mean : means) sum += mean.is_number() ? mean.get<double>() : 0;
  return fmt::format("{}, mean confidence {:.2f}", Counted(means.size(), "proposal"),
                     sum / static_cast<double>(means.size()));
}

std::string Scored(const json& record) {
  const json test = record.value("test", json::object());
  const json psnr = test.value("psnr", json()), ssim = test.value("ssim", json());
  if (!psnr.is_number() || !ssim.is_number()) return "no test pixels";
  return fmt::format("PSNR {:.2f} dB, SSIM {:.4f}", psnr.get<double>(), ssim.get<double>());
}

struct Row {
  const char* stage;
  std::string (*result)(const json& record);
};

constexpr Row kRows[] = {
    {"register",
     [](const json& r) {
       return fmt::format("{} of {}", Count(r, "registered"), Counted(Count(r, "photos"), "photo"));
     }},
    {"sfm", [](const json& r) { return Counted(Count(r, "points"), "point"); }},
    {"depth",
     [](const json& r) {
       std::string points = Counted(Count(r, "points"), "dense point");
       if (!r.contains("confident_share")) return points;  // from an early version
       return fmt::format("confident on {:.0f} % of the pixels, {}", 100 * r.value("confident_share", 0.0), points);
     }},
    {"proxies", [](const json& r) { return Counted(Count(r, "models"), "proxy model"); }},
    {"propose", Proposed},
    {"validate", Validated},
    {"train",
     [](const json& r) {
       return Counted(Count(r, "gaussians"), "Gaussian") + ", " + Counted(Count(r, "iterations"), "iteration");
     }},
    {"evaluate", Scored},
    {"report", [](const json&) { return std::string("report.html"); }},
};

}  // namespace

std::string StageTable(const json& before, const json& after) {
  std::vector<std::vector<std::string>> lines = {{"stage", "time", "predicted", "result"}};
  double total = 0, kept = 0, predicted_total = 0;
  bool any_predicted = false, all_predicted = true;
  for (const Row& row : kRows) {
    if (!after.contains(row.stage) || !after[row.stage].is_object()) continue;
    const json& record = after[row.stage];
    const double seconds = record.value("seconds", 0.0), predicted = record.value("predicted_seconds", 0.0);
    const bool unchanged = before.contains(row.stage) && before[row.stage] == record;
    lines.push_back({row.stage, FormatSeconds(seconds), predicted > 0 ? FormatSeconds(predicted) : "",
                     row.result(record) + (unchanged ? " (unchanged)" : "")});
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

}  // namespace oraclegs
