#include "oraclegs/experiments/ablation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/core/text.h"
#include "oraclegs/experiments/ablation_rows.h"
#include "oraclegs/settings/named_options.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr char kNone[] = "-";

using Value = std::optional<double> (*)(const AblationRun& run);
std::optional<double> Psnr(const AblationRun& run) { return run.psnr; }
std::optional<double> Ssim(const AblationRun& run) { return run.ssim; }
std::optional<double> Lpips(const AblationRun& run) { return run.lpips; }
std::optional<double> Corrected(const AblationRun& run) { return run.psnr_color_corrected; }
std::optional<double> Seconds(const AblationRun& run) { return run.training_seconds; }

/// Statistics over the scored runs.
std::optional<Statistic> StatisticOver(const AblationResult& row, Value value) {
  std::vector<double> values;
  for (const AblationRun& run : row.runs) {
    if (!run.failure.empty()) continue;
    if (const auto v = value(run)) values.push_back(*v);
  }
  return StatisticOf(values);
}

bool HasScores(const AblationResult& row) {
  for (const AblationRun& run : row.runs) {
    if (run.failure.empty()) return true;
  }
  return false;
}

std::string Shown(const std::optional<Statistic>& statistic, int decimals, bool sign = false) {
  if (!statistic) return kNone;
  std::string text =
      sign ? fmt::format("{:+.{}f}", statistic->mean, decimals) : fmt::format("{:.{}f}", statistic->mean, decimals);
  if (statistic->deviation) text += fmt::format(" ± {:.{}f}", *statistic->deviation, decimals);
  return text;
}

/// Text of a row in place of scores.
std::string WithoutScores(const AblationResult& row) {
  return row.runs.empty() ? "not run yet" : "failed: " + row.runs.front().failure;
}

/// "20.28 / 0.592 / 0.354", what the paper prints for a row; "-" for rows that it does not have.
std::string PublishedCell(const Ablation& ablation, const AblationResult& row) {
  for (const PublishedStep& step : PublishedSteps(ablation.published_views)) {
    if (step.row == row.name) return fmt::format("{} / {:.3f} / {:.3f}", step.psnr, step.ssim, step.lpips);
  }
  return kNone;
}

bool HasPublished(const Ablation& ablation) { return !ablation.scenes.empty() && ablation.published_views > 0; }

constexpr char kMisprint[] =
    "* a misprint of the paper: 6 dB above the full method, with SSIM and LPIPS between its neighbors";

/// Cells of a row that has scores.
std::vector<std::string> Cells(const Ablation& ablation, size_t r) {
  const AblationResult& row = ablation.rows[r];
  const std::optional<Gain> gain = GainOf(ablation, r);
  const std::optional<Statistic> seconds = StatisticOver(row, Seconds);
  return {Shown(StatisticOver(row, Psnr), 2),        Shown(StatisticOver(row, Ssim), 4),
          Shown(StatisticOver(row, Lpips), 4),       Shown(StatisticOver(row, Corrected), 2),
          gain ? Shown(gain->psnr, 2, true) : kNone, FormatSeconds(seconds->mean)};
}

/// Failures of rows that have scores of other seeds; empty without any.
std::vector<std::string> PartialFailures(const Ablation& ablation) {
  std::vector<std::string> lines;
  for (const AblationResult& row : ablation.rows) {
    if (!HasScores(row)) continue;
    for (const AblationRun& run : row.runs) {
      if (run.failure.empty()) continue;
      lines.push_back(fmt::format("row {} ({}), seed {} failed: {}", row.number, row.label, run.seed, run.failure));
    }
  }
  return lines;
}

/// Rows of a table of several ablations side by side; the first has the heads. Rows of the paper stand beside ours.
std::vector<std::vector<std::string>> SideBySide(const std::vector<Ablation>& ablations) {
  std::vector<std::vector<std::string>> lines = {{"row"}};
  for (const Ablation& a : ablations) {
    for (const char* head : {"PSNR", "SSIM", "LPIPS"}) lines[0].push_back(fmt::format("{} of {}", head, a.train_views));
    if (HasPublished(a)) lines[0].push_back(fmt::format("paper of {}", a.train_views));
  }
  for (const AblationResult& first : ablations.front().rows) {
    lines.push_back({fmt::format("{} {}", first.number, first.label)});
    for (const Ablation& a : ablations) {
      const auto same = [&](const AblationResult& row) { return row.name == first.name; };
      const auto row = std::find_if(a.rows.begin(), a.rows.end(), same);
      const bool has_scores = row != a.rows.end() && HasScores(*row);
      for (const auto& [value, decimals] : {std::pair<Value, int>{Psnr, 2}, {Ssim, 4}, {Lpips, 4}}) {
        lines.back().push_back(has_scores ? Shown(StatisticOver(*row, value), decimals) : kNone);
      }
      if (HasPublished(a)) lines.back().push_back(PublishedCell(a, first));
    }
  }
  return lines;
}

bool HasMisprint(const std::vector<Ablation>& ablations) {
  return std::any_of(ablations.begin(), ablations.end(),
                     [](const Ablation& a) { return HasPublished(a) && a.published_views == 24; });
}

std::string Protocol(const Ablation& a) {
  if (!a.scenes.empty()) {
    return fmt::format("mean over {}: {} iterations, at most {} Gaussians, seed{} {}", fmt::join(a.scenes, ", "),
                       a.iterations, a.max_gaussians, a.seeds.size() == 1 ? "" : "s", fmt::join(a.seeds, ", "));
  }
  return fmt::format("{} training views, {} test views, {} × {} pixels, {} iterations, at most {} Gaussians, seed{} {}",
                     a.train_views, a.test_views, a.width, a.height, a.iterations, a.max_gaussians,
                     a.seeds.size() == 1 ? "" : "s", fmt::join(a.seeds, ", "));
}

/// "--init sfm", as it is typed.
std::string Typed(const std::string& name, const json& value) {
  if (value == "") return "no " + RunOptionShown(name);
  return fmt::format("{}", fmt::join(RunOptionWords(name, value), " "));
}

/// Escapes text so that it stays within its cell and is no markup.
std::string InCell(const std::string& text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|' || c == '\\') cell += '\\';
    cell += c == '\n' ? ' ' : c;
  }
  return cell;
}

json ToJson(const std::optional<double>& value) { return value ? json(*value) : json(); }

json ToJson(const std::optional<Statistic>& statistic) {
  if (!statistic) return nullptr;
  return {{"mean", statistic->mean}, {"deviation", ToJson(statistic->deviation)}, {"count", statistic->count}};
}

json ToJson(const AblationRun& run) {
  json out = {{"seed", run.seed}, {"workspace", run.workspace}};
  if (!run.failure.empty()) {
    out["failure"] = run.failure;
    return out;
  }
  out["psnr"] = ToJson(run.psnr), out["ssim"] = ToJson(run.ssim);
  out["lpips"] = ToJson(run.lpips), out["psnr_color_corrected"] = ToJson(run.psnr_color_corrected);
  out["training_seconds"] = run.training_seconds, out["gaussians"] = run.gaussians, out["start"] = run.start;
  return out;
}

}  // namespace

std::optional<Statistic> StatisticOf(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  Statistic statistic{values.size(), 0, std::nullopt};
  const auto n = static_cast<double>(values.size());
  for (const double v : values) statistic.mean += v / n;
  if (values.size() == 1) return statistic;
  double squares = 0;
  for (const double v : values) squares += (v - statistic.mean) * (v - statistic.mean);
  statistic.deviation = std::sqrt(squares / (n - 1));
  return statistic;
}

std::optional<Gain> GainOf(const Ablation& ablation, size_t row) {
  for (size_t above = row; above-- > 0;) {
    if (!HasScores(ablation.rows[above])) continue;
    std::vector<double> gains;
    for (const AblationRun& now : ablation.rows[row].runs) {
      for (const AblationRun& then : ablation.rows[above].runs) {
        if (now.seed == then.seed && now.psnr && then.psnr) gains.push_back(*now.psnr - *then.psnr);
      }
    }
    const std::optional<Statistic> statistic = StatisticOf(gains);
    if (!statistic) return std::nullopt;
    return Gain{above, *statistic};
  }
  return std::nullopt;
}

json AblationToJson(const Ablation& a) {
  json rows = json::array();
  for (size_t r = 0; r < a.rows.size(); ++r) {
    const AblationResult& row = a.rows[r];
    json runs = json::array();
    for (const AblationRun& run : row.runs) runs.push_back(ToJson(run));
    const std::optional<Gain> gain = GainOf(a, r);
    rows.push_back({{"number", row.number},
                    {"name", row.name},
                    {"label", row.label},
                    {"explanation", row.explanation},
                    {"changes", row.changes},
                    {"psnr", ToJson(StatisticOver(row, Psnr))},
                    {"ssim", ToJson(StatisticOver(row, Ssim))},
                    {"lpips", ToJson(StatisticOver(row, Lpips))},
                    {"psnr_color_corrected", ToJson(StatisticOver(row, Corrected))},
                    {"training_seconds", ToJson(StatisticOver(row, Seconds))},
                    {"gain", gain ? ToJson(gain->psnr) : json()},
                    {"gain_over", gain ? json(a.rows[gain->over].name) : json()},
                    {"runs", std::move(runs)}});
  }
  return {{"program", "oraclegs"},
          {"version", a.version},
          {"command", a.command},
          {"scene", a.scene},
          {"scenes", a.scenes},
          {"views", {{"train", a.train_views}, {"test", a.test_views}}},
          {"published_views", a.published_views},
          {"width", a.width},
          {"height", a.height},
          {"iterations", a.iterations},
          {"max_gaussians", a.max_gaussians},
          {"seeds", a.seeds},
          {"rows", std::move(rows)},
          {"notes", a.notes}};
}

std::string AblationText(const Ablation& ablation) {
  std::vector<std::vector<std::string>> lines = {{"row", "PSNR", "SSIM", "LPIPS", "corrected", "gain", "training"}};
  for (size_t r = 0; r < ablation.rows.size(); ++r) {
    const AblationResult& row = ablation.rows[r];
    lines.push_back({fmt::format("{} {}", row.number, row.label)});
    std::vector<std::string> cells = {WithoutScores(row)};
    if (HasScores(row)) cells = Cells(ablation, r);
    if (HasScores(row) && HasPublished(ablation)) cells.push_back(PublishedCell(ablation, row));
    lines.back().insert(lines.back().end(), cells.begin(), cells.end());
  }
  if (HasPublished(ablation)) lines.front().emplace_back("paper");
  std::string text = Protocol(ablation) + "\n" + AlignColumns(lines, HasPublished(ablation) ? "lrrrrrrr" : "lrrrrrr");
  if (HasPublished(ablation) && ablation.published_views == 24) text += std::string(kMisprint) + "\n";
  for (const std::string& line : PartialFailures(ablation)) text += line + "\n";
  return text;
}

std::string SideBySideText(const std::vector<Ablation>& ablations) {
  const auto lines = SideBySide(ablations);
  std::string text;
  for (const Ablation& a : ablations) text += fmt::format("{} views: {}\n", a.train_views, Protocol(a));
  text += AlignColumns(lines, "l" + std::string(lines[0].size() - 1, 'r'));
  return text + (HasMisprint(ablations) ? std::string(kMisprint) + "\n" : "");
}

std::string SideBySideMarkdown(const std::vector<Ablation>& ablations) {
  const Ablation& first = ablations.front();
  std::string text =
      fmt::format("# Ablation of {}\n\noraclegs {}.\n\n    {}\n\n", first.scene, first.version, first.command);
  for (const Ablation& a : ablations) text += fmt::format("- {} views: {}\n", a.train_views, Protocol(a));
  text += "\n";
  const auto lines = SideBySide(ablations);
  for (size_t l = 0; l < lines.size(); ++l) {
    for (const std::string& cell : lines[l]) text += "| " + InCell(cell) + " ";
    text += "|\n";
    for (size_t c = 0; l == 0 && c < lines[0].size(); ++c) text += "| --- ";
    if (l == 0) text += "|\n";
  }
  if (HasMisprint(ablations)) text += fmt::format("\n{}\n", kMisprint);
  for (const Ablation& a : ablations) {
    text += fmt::format("\nThe options of each row, and each scene: {}-views/ablation.md\n", a.train_views);
  }
  return text;
}

std::string AblationMarkdown(const Ablation& ablation) {
  std::string text = fmt::format("# Ablation of {}\n\n{}; oraclegs {}.\n\n    {}\n\n", ablation.scene,
                                 Protocol(ablation), ablation.version, ablation.command);
  const bool has_published = HasPublished(ablation);
  text += fmt::format("| row | PSNR, dB | SSIM | LPIPS | PSNR, color-corrected | gain, dB | training |{}\n",
                      has_published ? " paper |" : "");
  text += fmt::format("| --- | --- | --- | --- | --- | --- | --- |{}\n", has_published ? " --- |" : "");
  for (size_t r = 0; r < ablation.rows.size(); ++r) {
    const AblationResult& row = ablation.rows[r];
    const std::string head = fmt::format("| {} {} |", row.number, InCell(row.label));
    const std::string last = has_published ? fmt::format(" {} |", PublishedCell(ablation, row)) : "";
    text += HasScores(row) ? fmt::format("{} {} |{}\n", head, fmt::join(Cells(ablation, r), " | "), last)
                           : fmt::format("{} {} | | | | | |{}\n", head, InCell(WithoutScores(row)), last);
  }
  if (has_published && ablation.published_views == 24) text += fmt::format("\n{}\n", kMisprint);
  text += "\n| row | adds | options |\n| --- | --- | --- |\n";
  for (const AblationResult& row : ablation.rows) {
    std::vector<std::string> options;
    for (const auto& [name, value] : row.changes.items())
      options.push_back(fmt::format("`{}`", InCell(Typed(name, value))));
    text += fmt::format("| {} {} | {} | {} |\n", row.number, InCell(row.label), InCell(row.explanation),
                        fmt::join(options, " "));
  }
  text += "\n";
  for (const std::string& line : PartialFailures(ablation)) text += "- " + line + "\n";
  for (const std::string& note : ablation.notes) text += "- " + note + "\n";
  return text;
}

}  // namespace oraclegs
