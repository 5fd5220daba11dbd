#include "oraclegs/experiments/bench/bench_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr std::array kScoreValues = {BenchValue::kPsnr, BenchValue::kSsim, BenchValue::kLpips};

size_t IndexOf(BenchValue value) { return static_cast<size_t>(value); }

std::string TimeCell(const BenchRow& row, BenchValue value) {
  const auto& seconds = row.value[IndexOf(value)];
  return seconds ? FormatSeconds(seconds->mean) : "-";
}

std::string MemoryCell(const BenchRow& row) {
  const auto& bytes = row.value[IndexOf(BenchValue::kPeakBytes)];
  return bytes ? fmt::format("{:.1f} GB", bytes->mean * 1e-9) : "-";
}

std::string GaussiansCell(const BenchRow& row) {
  const auto& count = row.value[IndexOf(BenchValue::kGaussians)];
  return count ? fmt::format("{:.0f}", count->mean) : "-";
}

/// Cells of the columns after the scores.
std::vector<std::string> CostCells(const BenchRow& row) {
  return {TimeCell(row, BenchValue::kSeconds), TimeCell(row, BenchValue::kCpuSeconds), MemoryCell(row),
          GaussiansCell(row)};
}

/// Cell of a score. A quoted score keeps the digits that its source prints.
std::string CellOf(const BenchRow& row, BenchValue value) {
  const auto& statistic = row.value[IndexOf(value)];
  if (row.source.empty() || !statistic || value == BenchValue::kPsnr) return ScoreCell(statistic, value);
  return fmt::format("{:.3f}", statistic->mean);
}

/// "20.32 / 0.596 / 0.350"
std::string PublishedCell(const BenchRow& row) {
  if (!row.published) return "";
  std::vector<std::string> parts;
  for (const BenchValue value : kScoreValues) {
    const auto number = PublishedValue(*row.published, value);
    parts.push_back(number ? fmt::format("{:.{}f}", *number, value == BenchValue::kPsnr ? 2 : 3) : "-");
  }
  return fmt::format("{}", fmt::join(parts, " / "));
}

std::string DifferenceCell(const BenchRow& row) {
  if (!row.published) return "";
  std::vector<std::string> parts;
  for (const BenchValue value : kScoreValues) {
    const auto number = DifferenceToPublished(row, value);
    parts.push_back(number ? fmt::format("{:+.{}f}", *number, value == BenchValue::kPsnr ? 2 : 3) : "-");
  }
  return fmt::format("{}", fmt::join(parts, " / "));
}

std::string SceneOf(const BenchRow& row) {
  if (!row.source.empty()) return "quoted";
  if (!row.is_mean()) return row.scene;
  if (row.scored == 0) return "mean";
  return row.scored == row.of ? "mean" : fmt::format("mean of {} of {}", row.scored, row.of);
}

std::vector<BenchRow> RowsOf(const std::vector<BenchRow>& rows, int views) {
  std::vector<BenchRow> found;
  for (const BenchRow& row : rows) {
    if (row.views == views) found.push_back(row);
  }
  return found;
}

bool HasPublished(const std::vector<BenchRow>& rows) {
  return std::any_of(rows.begin(), rows.end(), [](const BenchRow& row) { return row.published.has_value(); });
}

std::string ViewsText(int views) { return views > 0 ? fmt::format("{} training views", views) : "all training views"; }

std::string SeedsText(const BenchReport& report) {
  return fmt::format("seed{} {}", report.seeds.size() == 1 ? "" : "s", fmt::join(report.seeds, ", "));
}

/// "Best PSNR of a scene: OracleGS in 5 of 8, 3DGS in 3"; "" where nothing compares.
std::string WinsLine(const BenchReport& report, int views) {
  const BenchWins count = CountWins(report, views);
  if (count.of == 0) return "";
  std::string text;
  for (size_t m = 0; m < count.wins.size(); ++m) {
    text += fmt::format("{}{} in {}{}", m == 0 ? "Best PSNR of a scene: " : ", ", report.methods[m].label,
                        count.wins[m], m == 0 ? fmt::format(" of {}", count.of) : "");
  }
  return text;
}

/// Failures of runs in rows that have scores of other runs.
std::vector<std::string> PartialFailures(const BenchReport& report, const std::vector<BenchRow>& rows) {
  std::vector<std::string> lines;
  for (const BenchScore& run : report.runs) {
    if (!run.ended || run.failure.empty()) continue;
    const bool in_table = std::any_of(rows.begin(), rows.end(), [&](const BenchRow& row) {
      return row.scene == run.scene && row.views == run.views && row.method == run.method && !row.failure.empty();
    });
    if (!in_table) {
      lines.push_back(fmt::format("{}, {}, {}, seed {} failed: {}", run.scene, ViewsText(run.views), run.method,
                                  run.seed, run.failure));
    }
  }
  return lines;
}

/// Escapes text so that it stays within its cell and is no markup.
std::string InMarkdown(const std::string& text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|' || c == '\\' || c == '*' || c == '_') cell += '\\';
    cell += c == '\n' ? ' ' : c;
  }
  return cell;
}

std::string InLatex(const std::string& text) {
  std::string cell;
  for (const char c : text) {
    if (c == '\\') {
      cell += "\\textbackslash{}";
    } else if (c == '~' || c == '^') {
      cell += fmt::format("\\{}{{}}", c);
    } else {
      if (std::string("&%$#_{}").find(c) != std::string::npos) cell += '\\';
      cell += c;
    }
  }
  for (size_t at = 0; (at = cell.find(" ± ", at)) != std::string::npos;) cell.replace(at, 4, " $\\pm$ ");
  return cell;
}

std::string InCsv(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

std::string MarkdownRow(const BenchRow& row, bool with_published) {
  std::string text = fmt::format("| {} | {} |", InMarkdown(SceneOf(row)), InMarkdown(row.label));
  if (!row.failure.empty())
    return text + fmt::format(" {} | | | | | | |{}\n", InMarkdown(row.failure), with_published ? " | |" : "");
  for (const BenchValue value : kScoreValues) {
    const std::string cell = CellOf(row, value);
    text += row.best[IndexOf(value)] ? fmt::format(" **{}** |", cell) : fmt::format(" {} |", cell);
  }
  for (const std::string& cell : CostCells(row)) text += fmt::format(" {} |", cell);
  if (with_published) text += fmt::format(" {} | {} |", PublishedCell(row), DifferenceCell(row));
  return text + "\n";
}

std::string LatexRow(const BenchRow& row) {
  std::string text = fmt::format("{} & {}", InLatex(SceneOf(row)), InLatex(row.label));
  if (!row.failure.empty()) {
    return text + fmt::format(" & \\multicolumn{{7}}{{l}}{{{}}} \\\\\n", InLatex(row.failure));
  }
  for (const BenchValue value : kScoreValues) {
    const std::string cell = InLatex(CellOf(row, value));
    text += row.best[IndexOf(value)] ? fmt::format(" & \\textbf{{{}}}", cell) : " & " + cell;
  }
  for (const std::string& cell : CostCells(row)) text += " & " + cell;
  return text + " \\\\\n";
}

/// Explanation of the published numbers, once for each source.
std::vector<std::string> SourceLines(const std::vector<BenchRow>& rows) {
  std::vector<std::string> lines;
  for (const BenchRow& row : rows) {
    std::string line;
    if (!row.source.empty()) line = fmt::format("quoted: as printed in {}; not run here", row.source);
    if (row.published) line = fmt::format("published: as printed in {} (PSNR / SSIM / LPIPS)", row.published->source);
    if (!line.empty() && std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

json NumberOrNull(const std::optional<double>& value) { return value ? json(*value) : json(); }

json StatisticOrNull(const std::optional<Statistic>& statistic) {
  if (!statistic) return nullptr;
  return {{"mean", statistic->mean}, {"deviation", NumberOrNull(statistic->deviation)}, {"count", statistic->count}};
}

json RunToJson(const BenchScore& run) {
  json out = {{"scene", run.scene}, {"views", run.views},         {"method", run.method},
              {"seed", run.seed},   {"workspace", run.workspace}, {"ended", run.ended}};
  if (!run.failure.empty()) out["failure"] = run.failure;
  if (!run.is_scored()) return out;
  for (size_t v = 0; v < kBenchValues; ++v) out[kBenchValueKeys[v]] = NumberOrNull(run.value[v]);
  out["training_seconds"] = run.training_seconds, out["train_views"] = run.train_views;
  out["version"] = run.version, out["lpips_convention"] = run.lpips.empty() ? json() : json(run.lpips);
  return out;
}

json RowToJson(const BenchRow& row) {
  json out = {{"views", row.views},   {"scene", row.is_mean() ? json() : json(row.scene)},
              {"method", row.method}, {"label", row.label},
              {"scored", row.scored}, {"of", row.of}};
  out["source"] = row.source.empty() ? json() : json(row.source);
  if (!row.failure.empty()) out["failure"] = row.failure;
  for (size_t v = 0; v < kBenchValues; ++v) out[kBenchValueKeys[v]] = StatisticOrNull(row.value[v]);
  if (!row.published) return out;
  out["published"] = {{"source", row.published->source}};
  for (const BenchValue value : kScoreValues) {
    const char* key = kBenchValueKeys[IndexOf(value)];
    out["published"][key] = NumberOrNull(PublishedValue(*row.published, value));
    out["difference"][key] = NumberOrNull(DifferenceToPublished(row, value));
  }
  return out;
}

}  // namespace

std::string BenchText(const BenchReport& report) {
  std::string text;
  const std::vector<BenchRow> all = BenchRows(report);
  for (const int views : report.views) {
    const std::vector<BenchRow> rows = RowsOf(all, views);
    const bool with_published = HasPublished(rows);
    std::vector<std::vector<std::string>> lines = {
        {"scene", "method", "PSNR", "SSIM", "LPIPS", "time", "CPU time", "memory", "Gaussians"}};
    if (with_published) lines[0].insert(lines[0].end(), {"published", "difference"});
    for (const BenchRow& row : rows) {
      lines.push_back({SceneOf(row), row.label});
      if (!row.failure.empty()) {
        lines.back().push_back(row.failure);
        continue;
      }
      for (const BenchValue value : kScoreValues) lines.back().push_back(CellOf(row, value));
      for (std::string& cell : CostCells(row)) lines.back().push_back(std::move(cell));
      if (with_published) lines.back().insert(lines.back().end(), {PublishedCell(row), DifferenceCell(row)});
    }
    text += fmt::format("{}, {}, {}\n{}", report.label, ViewsText(views), SeedsText(report),
                        AlignColumns(lines, with_published ? "llrrrrrrrrr" : "llrrrrrrr"));
    const std::string wins = WinsLine(report, views);
    if (!wins.empty()) text += wins + "\n";
    for (const std::string& line : SourceLines(rows)) text += line + "\n";
    text += "\n";
  }
  for (const std::string& line : PartialFailures(report, all)) text += line + "\n";
  for (const std::string& note : report.notes) text += note + "\n";
  return text;
}

std::string BenchMarkdown(const BenchReport& report) {
  std::string text = fmt::format("# Benchmark on {}\n\n{}; oraclegs {}.\n\n    {}\n\n", report.label, SeedsText(report),
                                 report.version, report.command);
  text += "![Test PSNR over the number of training views](bench-views.svg)\n\n";
  text += "![Test PSNR over the time of a run](bench-time.svg)\n\n";
  const std::vector<BenchRow> all = BenchRows(report);
  for (const int views : report.views) {
    const std::vector<BenchRow> rows = RowsOf(all, views);
    const bool with_published = HasPublished(rows);
    text +=
        fmt::format("## {}\n\n| scene | method | PSNR, dB | SSIM | LPIPS | time | CPU time | memory | Gaussians |{}\n",
                    ViewsText(views), with_published ? " published | difference |" : "");
    text += fmt::format("| --- | --- | --- | --- | --- | --- | --- | --- | --- |{}\n",
                        with_published ? " --- | --- |" : "");
    for (const BenchRow& row : rows) text += MarkdownRow(row, with_published);
    const std::string wins = WinsLine(report, views);
    text += wins.empty() ? "\n" : fmt::format("\n{}.\n\n", InMarkdown(wins));
    for (const std::string& line : SourceLines(rows)) text += fmt::format("- {}\n", line);
    if (!SourceLines(rows).empty()) text += "\n";
  }
  text +=
      "- ± is the sample standard deviation over the seeds; that of a mean is the deviation of the mean over scenes. "
      "The best score of a scene, and of the means over all scenes, is bold.\n"
      "- time: from photos to the trained model, without scoring; stages that runs share count in each. CPU time: the "
      "same, of all threads and programs together; not known where training was continued. memory: of the largest "
      "process.\n";
  for (const BenchMethod& method : report.methods) {
    if (!method.citation.empty()) text += fmt::format("- {}: [{}], run here.\n", method.label, method.citation);
  }
  for (const std::string& line : PartialFailures(report, all)) text += fmt::format("- {}\n", line);
  for (const std::string& note : report.notes) text += fmt::format("- {}\n", note);
  return text;
}

std::string BenchLatex(const BenchReport& report) {
  std::string text =
      fmt::format("% {}\n% oraclegs {}; needs \\usepackage{{booktabs}}\n", OneLine(report.command), report.version);
  const std::vector<BenchRow> all = BenchRows(report);
  for (const int views : report.views) {
    const std::vector<BenchRow> rows = RowsOf(all, views);
    text += "\\begin{tabular}{llrrrrrrr}\n\\toprule\n";
    text += fmt::format("\\multicolumn{{9}}{{l}}{{{}, {}, {}}} \\\\\n", InLatex(report.label), ViewsText(views),
                        SeedsText(report));
    text +=
        "scene & method & PSNR $\\uparrow$ & SSIM $\\uparrow$ & LPIPS $\\downarrow$ & time & CPU time & memory & "
        "Gaussians \\\\\n";
    std::string scene;
    for (size_t r = 0; r < rows.size(); ++r) {
      const std::string group = rows[r].is_mean() ? (rows[r].source.empty() ? "mean" : "quoted") : rows[r].scene;
      if (r == 0 || group != scene) text += "\\midrule\n";
      scene = group;
      text += LatexRow(rows[r]);
      if (!rows[r].published) continue;
      text += fmt::format("& published & \\multicolumn{{7}}{{l}}{{{}; difference {}}} \\\\\n", PublishedCell(rows[r]),
                          DifferenceCell(rows[r]));
    }
    text += "\\bottomrule\n\\end{tabular}\n";
    for (const std::string& line : SourceLines(rows)) text += fmt::format("% {}\n", line);
    text += "\n";
  }
  return text;
}

json BenchToJson(const BenchReport& report) {
  json methods = json::array(), runs = json::array(), rows = json::array();
  for (const BenchMethod& m : report.methods) {
    methods.push_back(
        {{"name", m.name}, {"label", m.label}, {"citation", m.citation.empty() ? json() : json(m.citation)}});
  }
  for (const BenchScore& run : report.runs) runs.push_back(RunToJson(run));
  for (const BenchRow& row : BenchRows(report)) rows.push_back(RowToJson(row));
  return {{"program", "oraclegs"},   {"version", report.version}, {"command", report.command},
          {"suite", report.suite},   {"label", report.label},     {"scenes", report.scenes},
          {"views", report.views},   {"seeds", report.seeds},     {"methods", std::move(methods)},
          {"runs", std::move(runs)}, {"rows", std::move(rows)},   {"follows_protocol", report.compares},
          {"notes", report.notes}};
}

std::string BenchCsv(const BenchReport& report) {
  std::string text = "suite,views,scene,method,scored,of";
  for (const char* key : kBenchValueKeys) text += fmt::format(",{0},{0}_deviation", key);
  for (const char* column : {"published", "difference"}) {
    for (size_t v = 0; v < kBenchScores; ++v) text += fmt::format(",{}_{}", column, kBenchValueKeys[v]);
  }
  text += ",source,version,failure\n";
  const auto number = [](const std::optional<double>& value) { return value ? fmt::format("{:.9g}", *value) : ""; };
  for (const BenchRow& row : BenchRows(report)) {
    text += fmt::format("{},{},{},{},{},{}", InCsv(report.suite), row.views, InCsv(row.is_mean() ? "mean" : row.scene),
                        row.method, row.scored, row.of);
    for (const auto& statistic : row.value) {
      text += fmt::format(",{},{}", statistic ? number(statistic->mean) : "",
                          statistic ? number(statistic->deviation) : "");
    }
    for (const BenchValue value : kScoreValues) {
      text += fmt::format(",{}", number(row.published ? PublishedValue(*row.published, value) : std::nullopt));
    }
    for (const BenchValue value : kScoreValues) text += fmt::format(",{}", number(DifferenceToPublished(row, value)));
    const std::string source = row.published ? row.published->source : row.source;
    text += fmt::format(",{},{},{}\n", InCsv(source), InCsv(row.version), InCsv(row.failure));
  }
  return text;
}

}  // namespace oraclegs
