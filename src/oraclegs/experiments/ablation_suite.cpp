#include "oraclegs/experiments/ablation_suite.h"

#include <algorithm>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/ablation_rows.h"
#include "oraclegs/experiments/series.h"
#include "oraclegs/scene/read_scene.h"
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

/// The request for one of several scenes, in its folder.
AblationRequest InFolder(const AblationRequest& request, const fs::path& scene) {
  AblationRequest one = request;
  one.options.also.clear();
  one.run.scene = scene, one.run.out = request.run.out / NameOf(scene);
  return one;
}

void WriteTables(const fs::path& out, const nlohmann::json& report, const std::string& table) {
  const auto replace = nlohmann::json::error_handler_t::replace;
  WriteFileAtomically(out / kSuiteJson, report.dump(2, ' ', false, replace) + "\n");
  WriteFileAtomically(out / kSuiteMarkdown, table);
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
    WriteTables(out, AblationToJson(mean), AblationMarkdown(mean));
  }
  return mean;
}

std::string SceneCommands(const AblationRequest& request, const std::vector<fs::path>& scenes) {
  if (scenes.size() == 1) return AblationCommands(request);
  std::string text;
  for (const fs::path& scene : scenes) text += AblationCommands(InFolder(request, scene));
  return text;
}

SuiteAblation PlanSuiteAblation(const AblationRequest& request, const SuiteSettings& settings) {
  if (!request.options.also.empty())
    throw UsageError("--also adds scenes to one, and --suite has its own; leave it out");
  const Suite suite = FindSuite(request.options.suite);
  if (suite.is_folder()) {
    throw UsageError("--suite {} is no dataset of papers; give the scene itself, and more of them with --also",
                     request.options.suite);
  }
  const bool follows = settings.preset == "paper";
  const RunArguments of_all =
      settings.preset.empty() || follows ? RunArguments() : settings.read_preset(settings.preset);
  const std::string* asked_views = FindArgument(settings.asked, "views");
  const std::vector<int> all_views = ViewsOf(suite, asked_views ? *asked_views : "", of_all);
  const std::vector<SuiteScene> scenes = ScenesOf(suite, suite.name, request.run.scene);

  SuiteAblation plan;
  plan.label = suite.label;
  for (const int views : all_views) {
    RunArguments arguments = follows ? settings.read_preset(PaperPreset(suite, views)) : of_all;
    std::erase_if(arguments, [](const auto& option) { return IsOfProtocol(option.first); });
    arguments = Overlaid(Overlaid(suite.protocol(views), arguments), settings.asked);
    SuiteAblation::OfViews part{.views = views, .request = request, .scenes = {}};
    part.request.run.options = OptionsOf(arguments);
    part.request.run.options.frame.force = true;  // scored with the poses of the dataset, whatever a check says of them
    part.request.run.out = request.run.out / fmt::format("{}-views", views);
    for (const SuiteScene& scene : scenes) {
      for (SceneCheck& check : CheckScene(suite, scene, {views}, settings.asked)) {
        if (check.problem.empty()) part.scenes.push_back(scene.path);
        plan.checks.push_back(std::move(check));
      }
    }
    if (!part.scenes.empty()) plan.parts.push_back(std::move(part));
  }
  if (plan.parts.empty()) throw InputError("{}", plan.checks.front().problem);
  return plan;
}

std::string SuiteAblationText(const SuiteAblation& suite) {
  std::string text = fmt::format("{}\n{}\n", suite.label, CheckText(suite.checks));
  for (const SuiteAblation::OfViews& part : suite.parts) {
    for (const fs::path& scene : part.scenes) text += AblationCommands(InFolder(part.request, scene));
  }
  return text;
}

std::vector<Ablation> RunSuiteAblation(const AblationRequest& request, const SuiteAblation& suite,
                                       const Listener& listener) {
  const fs::path out = request.run.out;
  std::vector<std::string> names;
  for (const SuiteAblation::OfViews& part : suite.parts) names.push_back(part.request.run.out.filename().string());
  std::vector<std::string_view> content = {kSuiteJson, kSuiteMarkdown};
  content.insert(content.end(), names.begin(), names.end());
  RequireSeriesFolder(out, {"ablation of this suite", kSuiteJson, content});
  std::vector<Ablation> done;
  nlohmann::json report = {{"program", "oraclegs"}, {"suite", suite.label}, {"views", nlohmann::json::object()}};
  for (const SuiteAblation::OfViews& part : suite.parts) {
    done.push_back(RunScenes(part.request, part.scenes, listener));
    done.back().train_views = static_cast<size_t>(part.views);
    report["views"][std::to_string(part.views)] = AblationToJson(done.back());
    WriteTables(out, report, SideBySideMarkdown(done));
  }
  return done;
}

}  // namespace oraclegs
