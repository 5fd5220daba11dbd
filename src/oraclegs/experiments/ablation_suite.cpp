#include "oraclegs/experiments/ablation_suite.h"

#include <algorithm>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/experiments/ablation_rows.h"
#include "oraclegs/experiments/series.h"
#include "oraclegs/scene/split.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kSuiteJson[] = "ablation.json", kSuiteMarkdown[] = "ablation.md";

std::string NameOf(const fs::path& scene) {
  std::error_code ignored;
  const fs::path path = fs::weakly_canonical(scene, ignored).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

const AblationRun* RunOf(const AblationResult& row, uint64_t seed) {
  const auto found = std::find_if(row.runs.begin(), row.runs.end(), [&](const auto& run) { return run.seed == seed; });
  return found == row.runs.end() ? nullptr : &*found;
}

const AblationResult* RowOf(const Ablation& ablation, const std::string& name) {
  const auto found =
      std::find_if(ablation.rows.begin(), ablation.rows.end(), [&](const auto& row) { return row.name == name; });
  return found == ablation.rows.end() ? nullptr : &*found;
}

/// Mean of a value; nullopt where a run has none.
std::optional<double> MeanOf(const std::vector<const AblationRun*>& runs, std::optional<double> AblationRun::*value) {
  double sum = 0;
  for (const AblationRun* run : runs) {
    if (!(run->*value)) return std::nullopt;
    sum += *(run->*value);
  }
  return sum / static_cast<double>(runs.size());
}

AblationRun MeanRun(const std::vector<const AblationRun*>& runs, const std::vector<std::string>& names) {
  AblationRun mean;
  mean.seed = runs.front()->seed;
  for (size_t s = 0; s < runs.size(); ++s) {
    if (!runs[s]->failure.empty()) mean.failure = fmt::format("{}: {}", names[s], runs[s]->failure);
  }
  if (!mean.failure.empty()) return mean;
  mean.psnr = MeanOf(runs, &AblationRun::psnr), mean.ssim = MeanOf(runs, &AblationRun::ssim);
  mean.lpips = MeanOf(runs, &AblationRun::lpips);
  mean.psnr_color_corrected = MeanOf(runs, &AblationRun::psnr_color_corrected);
  const auto count = static_cast<double>(runs.size());
  double gaussians = 0;
  for (const AblationRun* run : runs) {
    mean.training_seconds += run->training_seconds / count;
    gaussians += static_cast<double>(run->gaussians) / count;
  }
  mean.gaussians = static_cast<int64_t>(gaussians);
  return mean;
}

}  // namespace

Ablation MeanOver(const std::vector<Ablation>& scenes) {
  Ablation mean = scenes.front();
  mean.scenes.clear(), mean.notes.clear(), mean.rows.clear();
  mean.train_views = mean.test_views = 0, mean.width = mean.height = 0;
  for (const Ablation& scene : scenes) {
    if (scene.published_views != mean.published_views) mean.published_views = 0;
    mean.scenes.push_back(NameOf(scene.scene));
    for (const std::string& note : scene.notes) {
      if (std::find(mean.notes.begin(), mean.notes.end(), note) == mean.notes.end()) mean.notes.push_back(note);
    }
  }
  if (!AreScenesOfPublishedSteps(mean.scenes)) mean.published_views = 0;
  mean.scene = fmt::format("{}", fmt::join(mean.scenes, ", "));
  for (const AblationResult& first : scenes.front().rows) {
    AblationResult row = first;
    row.runs.clear();
    std::vector<const AblationResult*> same;
    for (const Ablation& scene : scenes) {
      if (const AblationResult* found = RowOf(scene, row.name)) same.push_back(found);
    }
    if (same.size() < scenes.size()) continue;
    for (const AblationRun& run : first.runs) {
      std::vector<const AblationRun*> runs;
      for (const AblationResult* of_scene : same) {
        if (const AblationRun* found = RunOf(*of_scene, run.seed)) runs.push_back(found);
      }
      if (runs.size() == scenes.size()) row.runs.push_back(MeanRun(runs, mean.scenes));
    }
    mean.rows.push_back(std::move(row));
  }
  return mean;
}

std::vector<fs::path> ScenesOf(const AblationRequest& request) {
  std::vector<fs::path> scenes = {request.run.scene};
  for (const std::string& scene : SplitTrimmed(request.options.also, ',')) scenes.emplace_back(scene);
  std::vector<std::string> names;
  for (const fs::path& scene : scenes) names.push_back(NameOf(scene));
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) == 1) continue;
    throw UsageError("two scenes are called '{}'; give each a folder of a name of its own", name);
  }
  return scenes;
}

AblationRequest InFolder(const AblationRequest& request, const fs::path& scene) {
  AblationRequest one = request;
  one.options.also.clear();
  one.run.scene = scene, one.run.out = request.run.out / NameOf(scene);
  return one;
}

void WriteAblation(const fs::path& out, const nlohmann::json& report, const std::string& table) {
  const auto replace = nlohmann::json::error_handler_t::replace;
  WriteFileAtomically(out / kSuiteJson, report.dump(2, ' ', false, replace) + "\n");
  WriteFileAtomically(out / kSuiteMarkdown, table);
}

Ablation RunScenes(const AblationRequest& request, const std::vector<fs::path>& scenes, const Listener& listener) {
  const fs::path out = request.run.out;
  std::vector<std::string> names;
  for (const fs::path& scene : scenes) names.push_back(NameOf(scene));
  std::vector<std::string_view> content = {kSuiteJson, kSuiteMarkdown};
  content.insert(content.end(), names.begin(), names.end());
  RequireSeriesFolder(out, {"ablation of these scenes", kSuiteJson, content});
  // A scene that cannot be read is an error now, not after hours of training the scenes before it.
  for (const fs::path& scene : scenes) {
    RequireOutsideScene(out, scene);
    const Scene read = ReadScene(scene, {}, Silent());
    if (read.HasPoses()) SplitViews(read, WithListsRead(request.run.options.split));
  }
  std::vector<Ablation> done;
  Ablation mean;
  for (const fs::path& scene : scenes) {
    done.push_back(RunAblation(InFolder(request, scene), listener));
    mean = MeanOver(done);
    WriteAblation(out, AblationToJson(mean), AblationMarkdown(mean));
  }
  return mean;
}

std::string SceneCommands(const AblationRequest& request, const std::vector<fs::path>& scenes) {
  if (scenes.size() == 1) return AblationCommands(request);
  std::string text;
  for (const fs::path& scene : scenes) text += AblationCommands(InFolder(request, scene));
  return text;
}

}  // namespace oraclegs
