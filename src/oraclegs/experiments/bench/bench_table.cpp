#include "oraclegs/experiments/bench/bench_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace oraclegs {
namespace {

using Values = std::array<std::optional<Statistic>, kBenchValues>;

/// Scored runs of a method in one scene.
std::vector<const BenchScore*> ScoredRuns(const BenchReport& report, const BenchRow& row) {
  std::vector<const BenchScore*> runs;
  for (const BenchScore& run : report.runs) {
    if (run.views == row.views && run.scene == row.scene && run.method == row.method && run.is_scored()) {
      runs.push_back(&run);
    }
  }
  return runs;
}

/// Adds each version of the program that is not in the list.
void AddVersions(const std::vector<const BenchScore*>& runs, std::vector<std::string>* versions) {
  for (const BenchScore* run : runs) {
    const bool is_new = std::find(versions->begin(), versions->end(), run->version) == versions->end();
    if (is_new && !run->version.empty()) versions->push_back(run->version);
  }
}

/// Mean of a value; nullopt where a run has none.
std::optional<double> MeanValue(const std::vector<const BenchScore*>& runs, size_t v) {
  double sum = 0;
  for (const BenchScore* run : runs) {
    if (!run->value[v]) return std::nullopt;
    sum += *run->value[v];
  }
  return runs.empty() ? std::nullopt : std::optional(sum / static_cast<double>(runs.size()));
}

BenchRow SceneRow(const BenchReport& report, int views, const std::string& scene, const BenchMethod& method) {
  BenchRow row{.views = views, .scene = scene, .method = method.name, .label = method.label};
  row.of = report.seeds.size();
  const auto runs = ScoredRuns(report, row);
  row.scored = runs.size();
  std::vector<std::string> versions;
  AddVersions(runs, &versions);
  row.version = fmt::format("{}", fmt::join(versions, "; "));
  for (size_t v = 0; v < kBenchValues; ++v) {
    std::vector<double> values;
    for (const BenchScore* run : runs) {
      if (run->value[v]) values.push_back(*run->value[v]);
    }
    row.value[v] = StatisticOf(values);
  }
  if (!runs.empty()) return row;
  row.failure = "not run yet";
  for (const BenchScore& run : report.runs) {
    if (run.views == views && run.scene == scene && run.method == method.name && run.ended) {
      row.failure = "failed: " + run.failure;
      break;
    }
  }
  return row;
}

/// Mean over the scenes that have scores, for each seed that all of these have. Without such a seed it is the mean of
/// the scenes' means, without a deviation.
BenchRow MeanRow(const BenchReport& report, int views, const BenchMethod& method) {
  BenchRow row{.views = views, .method = method.name, .label = method.label};
  row.of = report.scenes.size();
  std::vector<std::vector<const BenchScore*>> by_scene;
  std::vector<std::string> versions;
  for (const std::string& scene : report.scenes) {
    BenchRow key{.views = views, .scene = scene, .method = method.name};
    auto runs = ScoredRuns(report, key);
    AddVersions(runs, &versions);
    if (!runs.empty()) by_scene.push_back(std::move(runs));
  }
  row.scored = by_scene.size();
  row.version = fmt::format("{}", fmt::join(versions, "; "));
  if (by_scene.empty()) {
    row.failure = "no scores";
    return row;
  }
  std::vector<std::vector<const BenchScore*>> by_seed;
  for (const uint64_t seed : report.seeds) {
    std::vector<const BenchScore*> runs;
    for (const auto& scene : by_scene) {
      const auto of_seed = std::find_if(scene.begin(), scene.end(), [&](const auto* run) { return run->seed == seed; });
      if (of_seed != scene.end()) runs.push_back(*of_seed);
    }
    if (runs.size() == by_scene.size()) by_seed.push_back(std::move(runs));
  }
  for (size_t v = 0; v < kBenchValues; ++v) {
    std::vector<double> values;
    for (const auto& runs : by_seed.empty() ? by_scene : by_seed) {
      if (const auto mean = MeanValue(runs, v)) values.push_back(*mean);
    }
    row.value[v] = StatisticOf(values);
    if (!by_seed.empty() || !row.value[v]) continue;
    row.value[v]->deviation.reset();  // it would be the deviation between scenes
  }
  return row;
}

/// Marks the best scores among the rows of one scene or of the means; scores that print alike are equally good. Marks
/// nothing where only one row has scores.
void MarkBest(std::vector<BenchRow>::iterator begin, std::vector<BenchRow>::iterator end) {
  for (size_t v = 0; v < kBenchScores; ++v) {
    const auto value = static_cast<BenchValue>(v);
    const BenchRow* best = nullptr;
    size_t count = 0;
    for (auto row = begin; row != end; ++row) {
      if (!row->value[v] || (row->is_mean() && row->scored < row->of)) continue;
      ++count;
      const bool lower = value == BenchValue::kLpips;
      if (!best || (lower ? row->value[v]->mean < best->value[v]->mean : row->value[v]->mean > best->value[v]->mean)) {
        best = &*row;
      }
    }
    if (count < 2) continue;
    const auto printed = [&](const BenchRow& row) {
      return ScoreCell(Statistic{1, row.value[v]->mean, std::nullopt}, value);
    };
    for (auto row = begin; row != end; ++row) {
      if (!row->value[v] || (row->is_mean() && row->scored < row->of)) continue;
      row->best[v] = printed(*row) == printed(*best);
    }
  }
}

void AddPublished(const BenchReport& report, int views, size_t first_mean, std::vector<BenchRow>* rows) {
  if (!report.compares) return;
  for (const PublishedScore& score : PublishedFor(report.suite, views)) {
    const auto own = std::find_if(rows->begin() + static_cast<ptrdiff_t>(first_mean), rows->end(),
                                  [&](const BenchRow& row) { return row.method == score.method; });
    if (own != rows->end()) {
      if (own->scored == own->of && own->of > 0) own->published = score;
      continue;
    }
    BenchRow row{.views = views, .method = score.method, .label = score.label, .source = score.source};
    for (size_t v = 0; v < kBenchScores; ++v) {
      if (const auto value = PublishedValue(score, static_cast<BenchValue>(v))) {
        row.value[v] = Statistic{1, *value, std::nullopt};
      }
    }
    rows->push_back(std::move(row));
  }
}

}  // namespace

std::vector<BenchRow> BenchRows(const BenchReport& report) {
  std::vector<BenchRow> rows;
  for (const int views : report.views) {
    for (const std::string& scene : report.scenes) {
      const auto first = static_cast<ptrdiff_t>(rows.size());
      for (const BenchMethod& method : report.methods) rows.push_back(SceneRow(report, views, scene, method));
      MarkBest(rows.begin() + first, rows.end());
    }
    const size_t first = rows.size();
    for (const BenchMethod& method : report.methods) rows.push_back(MeanRow(report, views, method));
    MarkBest(rows.begin() + static_cast<ptrdiff_t>(first), rows.end());
    AddPublished(report, views, first, &rows);
  }
  return rows;
}

BenchWins CountWins(const BenchReport& report, int views) {
  BenchWins count;
  count.wins.resize(report.methods.size());
  for (const std::string& scene : report.scenes) {
    std::vector<BenchRow> rows;
    for (const BenchMethod& method : report.methods) rows.push_back(SceneRow(report, views, scene, method));
    MarkBest(rows.begin(), rows.end());
    bool any = false;
    for (size_t m = 0; m < rows.size(); ++m) {
      if (!rows[m].best[static_cast<size_t>(BenchValue::kPsnr)]) continue;
      ++count.wins[m];
      any = true;
    }
    count.of += any ? 1 : 0;
  }
  return count;
}

std::string ScoreCell(const std::optional<Statistic>& statistic, BenchValue value) {
  if (!statistic) return "-";
  const int decimals = value == BenchValue::kPsnr ? 2 : 4;
  std::string text = fmt::format("{:.{}f}", statistic->mean, decimals);
  if (statistic->deviation) text += fmt::format(" ± {:.{}f}", *statistic->deviation, decimals);
  return text;
}

std::optional<double> PublishedValue(const PublishedScore& score, BenchValue value) {
  switch (value) {
    case BenchValue::kPsnr:
      return score.psnr;
    case BenchValue::kSsim:
      return score.ssim;
    case BenchValue::kLpips:
      return score.lpips;
    default:
      return std::nullopt;
  }
}

std::optional<double> DifferenceToPublished(const BenchRow& row, BenchValue value) {
  const auto& ours = row.value[static_cast<size_t>(value)];
  if (!row.published || !ours) return std::nullopt;
  const auto theirs = PublishedValue(*row.published, value);
  return theirs ? std::optional(ours->mean - *theirs) : std::nullopt;
}

}  // namespace oraclegs
