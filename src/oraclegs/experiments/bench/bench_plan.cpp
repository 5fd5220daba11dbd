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

/// Options of a run. Later ones win: the suite's, the method's usual ones, the user's, those that make the method.
RunArguments ArgumentsOf(const BenchRequest& request, const BenchPlan& plan, const BenchRun& run) {
  const MethodSettings method = plan.methods[run.method].For(plan.suite.name);
  RunArguments arguments = Overlaid(plan.suite.protocol(plan.checks[run.check].views), method.usual);
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
  const size_t at = suite.preset.find("{}");
  const bool is_published = std::find(suite.views.begin(), suite.views.end(), views) != suite.views.end();
  if (at == std::string::npos || !is_published) return "";
  return suite.preset.substr(0, at) + std::to_string(views) + suite.preset.substr(at + 2);
}

}  // namespace

BenchPlan PlanBench(const BenchRequest& request) {
  const BenchOptions& options = request.options;
  BenchPlan plan;
  plan.suite = FindSuite(options.suite);
  plan.methods = FindMethods(options.methods);
  plan.views = ViewsOf(plan.suite, options.views);
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
