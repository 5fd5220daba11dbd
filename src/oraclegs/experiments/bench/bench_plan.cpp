#include "oraclegs/experiments/bench/bench_plan.h"

#include <algorithm>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

std::string RunName(const BenchPlan& plan, const BenchRun& run) {
  const SceneCheck& check = plan.checks[run.check];
  return fmt::format("{}-{}-{}-{}-seed{}", plan.suite.name, check.scene.name,
                     check.views > 0 ? std::to_string(check.views) : "all", plan.methods[run.method].name, run.seed);
}

MethodSettings SettingsOf(const BenchRequest& request, const BenchPlan& plan, const BenchRun& run) {
  const Method& method = plan.methods[run.method];
  if (method.options) return method.For(plan.suite.name);
  MethodSettings settings;
  for (const auto& argument : request.read_preset(PaperPreset(plan.suite, plan.checks[run.check].views))) {
    if (IsOfProtocol(argument.first)) continue;
    (argument.first == "iterations" ? settings.usual : settings.options).push_back(argument);
  }
  return settings;
}

/// Options of a run. Later ones win: the suite's, the method's usual ones, those of the user's preset where the method
/// is this program's own, the user's, those that make the method.
RunArguments ArgumentsOf(const BenchRequest& request, const BenchPlan& plan, const BenchRun& run) {
  const MethodSettings method = SettingsOf(request, plan, run);
  RunArguments arguments = Overlaid(plan.suite.protocol(plan.checks[run.check].views), method.usual);
  if (plan.methods[run.method].is_own()) arguments = Overlaid(std::move(arguments), request.preset);
  arguments = Overlaid(Overlaid(std::move(arguments), request.asked), method.options);
  return Overlaid(std::move(arguments), {{"seed", std::to_string(run.seed)}, {"report", "false"}});
}

std::string QuotedWords(const std::vector<std::string>& words) {
  std::vector<std::string> quoted;
  for (const std::string& word : words) quoted.push_back(ShellQuoted(word));
  return fmt::format("{}", fmt::join(quoted, " "));
}

/// "paper-blender-8"; "" without such a preset.
std::string PresetOf(const Suite& suite, int views) {
  const bool is_published = std::find(suite.views.begin(), suite.views.end(), views) != suite.views.end();
  return is_published ? fmt::format(fmt::runtime(suite.preset), views) : "";
}

}  // namespace

BenchPlan PlanBench(const BenchRequest& asked) {
  BenchRequest request = asked;
  const BenchOptions& options = request.options;
  BenchPlan plan;
  plan.suite = FindSuite(options.suite);
  plan.methods = FindMethods(options.methods);
  plan.views = ViewsOf(plan.suite, options.views, request.preset);
  const auto of_protocol = [](const auto& option) { return IsOfProtocol(option.first) && option.first != "views"; };
  RunArguments common;
  std::copy_if(request.preset.begin(), request.preset.end(), std::back_inserter(common), of_protocol);
  request.asked = Overlaid(std::move(common), request.asked);
  std::erase_if(request.preset, [](const auto& option) { return IsOfProtocol(option.first); });
  plan.keeps_protocol = !plan.suite.is_folder() && KeepsProtocol(plan.suite, plan.views, request.asked);
  RequireOneList(plan.suite, plan.views, request.asked);
  for (int s = 0; s < options.seeds; ++s) plan.seeds.push_back(request.first_seed + static_cast<uint64_t>(s));
  for (const SuiteScene& scene : ScenesOf(plan.suite, options.suite, options.data)) {
    for (SceneCheck& check : CheckScene(plan.suite, scene, plan.views, request.asked)) {
      plan.checks.push_back(std::move(check));
    }
  }
  const auto fits = [](const SceneCheck& check) { return check.problem.empty(); };
  if (std::none_of(plan.checks.begin(), plan.checks.end(), fits)) {
    throw InputError("{}", plan.checks.front().problem);
  }
  for (size_t c = 0; c < plan.checks.size(); ++c) {
    for (const uint64_t seed : plan.seeds) {
      for (size_t m = 0; m < plan.methods.size(); ++m) {
        BenchRun run{.check = c, .method = m, .seed = seed};
        run.name = RunName(plan, run), run.arguments = ArgumentsOf(request, plan, run);
        OptionsOf(run.arguments);  // reports values that do not fit now
        plan.runs.push_back(std::move(run));
      }
    }
  }
  return plan;
}

fs::path WorkspaceOf(const BenchRequest& request, const BenchRun& run) {
  return fs::absolute(request.out / "runs" / run.name).lexically_normal();
}

std::vector<std::string> CommandOf(const BenchRequest& request, const BenchPlan& plan, const BenchRun& run) {
  const fs::path scene = fs::absolute(plan.checks[run.check].scene.path).lexically_normal();
  std::vector<std::string> words = {request.program.string(), "reconstruct", scene.string(), "--out",
                                    WorkspaceOf(request, run).string()};
  const std::vector<std::string> options = ArgumentWords(run.arguments);
  words.insert(words.end(), options.begin(), options.end());
  // A dataset is scored with its own poses, even where a check doubts them.
  if (!FindArgument(run.arguments, "force")) words.emplace_back("--force");
  return words;
}

std::string PlanText(const BenchRequest& request, const BenchPlan& plan) {
  std::vector<std::string> labels;
  for (const Method& method : plan.methods) {
    labels.push_back(method.label + (method.needs.empty() ? "" : fmt::format(" (needs {})", method.needs)));
  }
  std::string text =
      fmt::format("{}: {}; {}\n", plan.suite.label, Counted(plan.runs.size(), "run"), fmt::join(labels, ", "));
  for (const int views : plan.views) {
    const std::string preset = PresetOf(plan.suite, views);
    if (!preset.empty()) text += fmt::format("{} views: the images of preset {}\n", views, preset);
  }
  if (!plan.suite.is_folder() && !plan.keeps_protocol) {
    text += "not the suite's protocol: options change its images or their size, so no published scores compare\n";
  }
  text += LpipsText(request.asked) + "\n" + CheckText(plan.checks) + "\n";
  for (const BenchRun& run : plan.runs) {
    if (plan.checks[run.check].problem.empty()) text += QuotedWords(CommandOf(request, plan, run)) + "\n";
  }
  return text;
}

}  // namespace oraclegs
