#include "oraclegs/experiments/bench/suite_ablation.h"

#include <nlohmann/json.hpp>

#include "oraclegs/core/text.h"
#include "oraclegs/experiments/series.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

}  // namespace

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
  std::vector<std::string_view> content = {"ablation.json", "ablation.md"};
  content.insert(content.end(), names.begin(), names.end());
  RequireSeriesFolder(out, {"ablation of this suite", "ablation.json", content});
  std::vector<Ablation> done;
  nlohmann::json report = {{"program", "oraclegs"}, {"suite", suite.label}, {"views", nlohmann::json::object()}};
  for (const SuiteAblation::OfViews& part : suite.parts) {
    done.push_back(RunScenes(part.request, part.scenes, listener));
    done.back().train_views = static_cast<size_t>(part.views);
    report["views"][std::to_string(part.views)] = AblationToJson(done.back());
    WriteAblation(out, report, SideBySideMarkdown(done));
  }
  return done;
}

}  // namespace oraclegs
