#include "oraclegs/experiments/tampering_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "oraclegs/core/text.h"
#include "oraclegs/experiments/line_chart.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr std::array kTrusts = {TamperingTrust::kNone, TamperingTrust::kUniform, TamperingTrust::kOracle,
                                TamperingTrust::kIdeal};
const std::vector<std::string> kColumns = {"tampered", "none",  "uniform", "oracle",      "ideal",
                                           "recovery", "AUROC", "in void", "on tampered", "on honest"};

const char* NameOf(TamperingTrust trust) { return kTamperingTrustNames[static_cast<size_t>(trust)]; }

/// Mean over seeds of a figure of the confidence.
template <class Value>
std::optional<double> MeanOver(const TamperingShare& share, Value&& number) {
  std::vector<double> values;
  for (const TamperedConfidence& c : share.confidence) {
    if (const std::optional<double> value = number(c)) values.push_back(*value);
  }
  const std::optional<Statistic> statistic = StatisticOf(values);
  return statistic ? std::optional(statistic->mean) : std::nullopt;
}

std::optional<double> MeanConfidence(const TamperingShare& share, std::optional<double> TamperedConfidence::*field) {
  return MeanOver(share, [&](const TamperedConfidence& c) { return c.*field; });
}

std::optional<double> AurocOfKind(const TamperingShare& share, size_t kind) {
  return MeanOver(share, [&](const TamperedConfidence& c) { return c.auroc_of_kind[kind]; });
}

std::string Number(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::string PsnrCell(const std::optional<Statistic>& statistic) {
  if (!statistic) return "-";
  return statistic->deviation ? fmt::format("{:.2f} ± {:.2f}", statistic->mean, *statistic->deviation)
                              : fmt::format("{:.2f}", statistic->mean);
}

std::vector<std::string> ShareCells(const TamperingReport& report, size_t s) {
  const TamperingShare& share = report.shares[s];
  std::vector<std::string> cells = {fmt::format("{} %", share.percent)};
  for (const TamperingTrust trust : kTrusts) cells.push_back(PsnrCell(TamperingPsnr(report, s, trust)));
  cells.push_back(Number(TamperingRecovery(report, s), 2));
  cells.push_back(Number(MeanConfidence(share, &TamperedConfidence::auroc), 3));
  cells.push_back(Number(MeanConfidence(share, &TamperedConfidence::auroc_void), 3));
  cells.push_back(Number(MeanConfidence(share, &TamperedConfidence::on_tampered), 3));
  cells.push_back(Number(MeanConfidence(share, &TamperedConfidence::on_honest), 3));
  return cells;
}

/// Table with a line for each kind that has pixels and a column for each share that has them; empty when there are
/// none.
std::vector<std::vector<std::string>> KindTable(const TamperingReport& report) {
  std::vector<size_t> shares;
  std::vector<std::vector<std::string>> lines = {{"kind"}};
  for (size_t s = 0; s < report.shares.size(); ++s) {
    if (!MeanConfidence(report.shares[s], &TamperedConfidence::auroc)) continue;
    shares.push_back(s);
    lines[0].push_back(fmt::format("{} %", report.shares[s].percent));
  }
  if (shares.empty()) return {};
  for (size_t kind = 0; kind < kGaussianTamperKindNames.size(); ++kind) {
    lines.push_back({kGaussianTamperKindNames[kind]});
    for (const size_t s : shares) lines.back().push_back(Number(AurocOfKind(report.shares[s], kind), 3));
  }
  return lines;
}

std::string ProtocolOf(const TamperingReport& r) {
  return fmt::format(
      "{} training views, {} test views, {} proposals, {} × {} pixels, {} iterations, at most {} Gaussians, seed{} {}",
      r.train_views, r.test_views, r.proposals, r.width, r.height, r.iterations, r.max_gaussians,
      r.seeds.size() == 1 ? "" : "s", fmt::join(r.seeds, ", "));
}

std::string WorstLine(const TamperingReport& report) {
  const std::optional<double> worst = WorstOverNone(report);
  return worst ? fmt::format("Worst of oracle − none: {:+.2f} dB", *worst) : "";
}

/// Markdown table of the lines; the first one is the header.
std::string MarkdownTable(const std::vector<std::vector<std::string>>& lines) {
  std::string text = fmt::format("| {} |\n|", fmt::join(lines[0], " | "));
  for (size_t c = 0; c < lines[0].size(); ++c) text += " --- |";
  text += "\n";
  for (size_t l = 1; l < lines.size(); ++l) text += fmt::format("| {} |\n", fmt::join(lines[l], " | "));
  return text;
}

json OrNull(const std::optional<double>& value) { return value ? json(*value) : json(); }

json StatisticToJson(const std::optional<Statistic>& statistic) {
  if (!statistic) return nullptr;
  return {{"mean", statistic->mean}, {"deviation", OrNull(statistic->deviation)}, {"count", statistic->count}};
}

json RunsToJson(const std::vector<TamperingRun>& runs) {
  json list = json::array();
  for (const TamperingRun& run : runs) {
    list.push_back(
        {{"seed", run.seed}, {"trust", NameOf(run.trust)}, {"workspace", run.workspace}, {"psnr", OrNull(run.psnr)}});
  }
  return list;
}

template <class Value>
json KindsToJson(Value&& auroc) {
  json kinds = json::object();
  for (size_t kind = 0; kind < kGaussianTamperKindNames.size(); ++kind) {
    kinds[kGaussianTamperKindNames[kind]] = OrNull(auroc(kind));
  }
  return kinds;
}

json ConfidenceToJson(const TamperedConfidence& c) {
  return {{"seed", c.seed},
          {"tampered", c.tampered},
          {"lies", c.lies},
          {"auroc", OrNull(c.auroc)},
          {"auroc_void", OrNull(c.auroc_void)},
          {"on_tampered", OrNull(c.on_tampered)},
          {"on_honest", OrNull(c.on_honest)},
          {"auroc_of_kind", KindsToJson([&](size_t kind) { return c.auroc_of_kind[kind]; })}};
}

constexpr std::array kLineColors = {"#777777", "#c0392b", "#1f5fbf", "#2e8b57"};

}  // namespace

std::optional<Statistic> TamperingPsnr(const TamperingReport& report, size_t share, TamperingTrust trust) {
  std::vector<double> values;
  for (const TamperingRun& run : trust == TamperingTrust::kNone ? report.none : report.shares[share].runs) {
    if (run.trust == trust && run.psnr) values.push_back(*run.psnr);
  }
  return StatisticOf(values);
}

std::optional<double> TamperingRecovery(const TamperingReport& report, size_t share) {
  const auto uniform = TamperingPsnr(report, share, TamperingTrust::kUniform);
  const auto oracle = TamperingPsnr(report, share, TamperingTrust::kOracle);
  const auto ideal = TamperingPsnr(report, share, TamperingTrust::kIdeal);
  if (!uniform || !oracle || !ideal || ideal->mean - uniform->mean < kMinIdealGain) return std::nullopt;
  return (oracle->mean - uniform->mean) / (ideal->mean - uniform->mean);
}

std::optional<double> WorstOverNone(const TamperingReport& report) {
  std::optional<double> worst;
  for (size_t s = 0; s < report.shares.size(); ++s) {
    const auto none = TamperingPsnr(report, s, TamperingTrust::kNone);
    const auto oracle = TamperingPsnr(report, s, TamperingTrust::kOracle);
    if (!none || !oracle) continue;
    const double difference = oracle->mean - none->mean;
    worst = std::min(worst.value_or(difference), difference);
  }
  return worst;
}

json TamperingToJson(const TamperingReport& r) {
  json shares = json::array();
  for (size_t s = 0; s < r.shares.size(); ++s) {
    const TamperingShare& share = r.shares[s];
    json psnr = json::object(), confidence = json::array();
    for (const TamperingTrust trust : kTrusts) psnr[NameOf(trust)] = StatisticToJson(TamperingPsnr(r, s, trust));
    for (const TamperedConfidence& c : share.confidence) confidence.push_back(ConfidenceToJson(c));
    shares.push_back({{"percent", share.percent},
                      {"psnr", std::move(psnr)},
                      {"recovery", OrNull(TamperingRecovery(r, s))},
                      {"auroc", OrNull(MeanConfidence(share, &TamperedConfidence::auroc))},
                      {"auroc_void", OrNull(MeanConfidence(share, &TamperedConfidence::auroc_void))},
                      {"on_tampered", OrNull(MeanConfidence(share, &TamperedConfidence::on_tampered))},
                      {"on_honest", OrNull(MeanConfidence(share, &TamperedConfidence::on_honest))},
                      {"auroc_of_kind", KindsToJson([&](size_t kind) { return AurocOfKind(share, kind); })},
                      {"runs", RunsToJson(share.runs)},
                      {"confidence", std::move(confidence)}});
  }
  return {{"program", "oraclegs"},
          {"version", r.version},
          {"command", r.command},
          {"scene", r.scene},
          {"views", {{"train", r.train_views}, {"test", r.test_views}, {"proposals", r.proposals}}},
          {"width", r.width},
          {"height", r.height},
          {"iterations", r.iterations},
          {"max_gaussians", r.max_gaussians},
          {"seeds", r.seeds},
          {"none", RunsToJson(r.none)},
          {"shares", std::move(shares)},
          {"worst_over_none", OrNull(WorstOverNone(r))},
          {"notes", r.notes}};
}

std::string TamperingText(const TamperingReport& report) {
  std::vector<std::vector<std::string>> lines = {kColumns};
  for (size_t s = 0; s < report.shares.size(); ++s) lines.push_back(ShareCells(report, s));
  const std::string worst = WorstLine(report);
  std::string text = ProtocolOf(report) + "\n" + AlignColumns(lines, std::string(kColumns.size(), 'r')) +
                     (worst.empty() ? "" : worst + "\n");
  const std::vector<std::vector<std::string>> kinds = KindTable(report);
  if (kinds.empty()) return text;
  return text +
         fmt::format("AUROC by kind of lie\n{}", AlignColumns(kinds, 'l' + std::string(kinds[0].size() - 1, 'r')));
}

std::string TamperingMarkdown(const TamperingReport& report) {
  std::string text = fmt::format(
      "# Tampering benchmark of {}\n\n{}; oraclegs {}.\n\n    {}\n\n![Test PSNR over the tampered share]"
      "(tampering.svg)\n\n",
      report.scene, ProtocolOf(report), report.version, report.command);
  std::vector<std::vector<std::string>> lines = {kColumns};
  for (size_t s = 0; s < report.shares.size(); ++s) lines.push_back(ShareCells(report, s));
  text += MarkdownTable(lines);
  const std::string worst = WorstLine(report);
  if (!worst.empty()) text += "\n" + worst + ".\n";
  const std::vector<std::vector<std::string>> kinds = KindTable(report);
  if (!kinds.empty()) text += "\nAUROC by kind of lie:\n\n" + MarkdownTable(kinds);
  text +=
      "\n"
      "- tampered: share of the proposals' pixels; none, uniform, oracle, ideal: PSNR of the test views in dB, mean ± "
      "sample standard deviation over the seeds, trained without proposals, with all proposed pixels trusted alike, as "
      "the oracle says, and with the honest pixels alone.\n"
      "- recovery: (oracle − uniform) / (ideal − uniform); none where the ideal oracle gains less than 0.05 dB.\n"
      "- AUROC: of low confidence as a sign of a tampered pixel that two photos or more see; in void: the same where "
      "at most one does. By kind: of the pixels that the lies of one kind make differ by themselves, against honest "
      "ones.\n"
      "- on tampered, on honest: mean confidence of such pixels.\n";
  for (const std::string& note : report.notes) text += "- " + note + "\n";
  return text;
}

std::string TamperingPlot(const TamperingReport& report) {
  LineChart chart{.x_title = "tampered pixels of the proposals", .y_title = "test PSNR, dB", .x_high = 100};
  for (const TamperingShare& share : report.shares) {
    chart.ticks.push_back({static_cast<double>(share.percent), fmt::format("{} %", share.percent)});
  }
  for (size_t t = 0; t < kTamperingTrustNames.size(); ++t) {
    ChartLine line{kTamperingTrustNames[t], kLineColors[t], {}};
    for (size_t s = 0; s < report.shares.size(); ++s) {
      if (const auto psnr = TamperingPsnr(report, s, static_cast<TamperingTrust>(t))) {
        line.points.push_back({static_cast<double>(report.shares[s].percent), psnr->mean});
      }
    }
    chart.lines.push_back(std::move(line));
  }
  return ChartSvg(chart);
}

}  // namespace oraclegs
