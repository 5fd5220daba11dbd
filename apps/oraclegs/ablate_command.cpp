#include "config_file.h"
#include "oraclegs/experiments/bench/suite_ablation.h"
#include "oraclegs/experiments/tampering.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class AblateCommand : public WorkspaceCommand {
 public:
  explicit AblateCommand(CLI::App* app)
      : WorkspaceCommand(app, "ablate", "Ablation study: add one component at a time and tabulate the gain",
                         "oraclegs ablate scene/ -o out/ --views 12 --seeds 3 --also other/\n"
                         "  oraclegs ablate datasets/ -o out/ --suite mipnerf360 --preset paper --dry-run\n"
                         "  oraclegs ablate scene/ -o out/ --views 12 --compare tampering") {
    Bind("Ablation", &options_);
  }

 private:
  void TakePreset(const std::string& name) override {
    preset_ = name;
    if (options_.suite.empty()) Command::TakePreset(name);
  }

  void Fill(const RunRequest& request, const Listener& listener) override {
    RunRequest one = request;
    one.scene = OneFolder(request);
    one.inputs.clear();
    const AblationRequest ablation{one, options_, CommandLine()};
    if (options_.compare == Comparison::kTampering) return Tamper(ablation, listener);
    if (!options_.suite.empty()) return FillSuite(ablation, listener);
    const std::vector<std::filesystem::path> scenes = ScenesOf(ablation);
    if (options_.dry_run) return Print(SceneCommands(ablation, scenes));
    PrintResult(
        AblationText(scenes.size() > 1 ? RunScenes(ablation, scenes, listener) : RunAblation(ablation, listener)),
        request.out / "ablation.md");
  }

  void Tamper(const AblationRequest& ablation, const Listener& listener) const {
    for (const auto& [name, given] : {std::pair{"also", !options_.also.empty()},
                                      {"suite", !options_.suite.empty()},
                                      {"dry-run", options_.dry_run}}) {
      if (given) throw UsageError("--{} goes with --compare parts; leave it out", name);
    }
    PrintResult(TamperingText(RunTampering(ablation, listener)), ablation.run.out / "tampering.md");
  }

  void FillSuite(const AblationRequest& ablation, const Listener& listener) {
    const SuiteAblation suite =
        PlanSuiteAblation(ablation, {GivenArguments(table(), ablation.run.options), preset_, PresetArguments});
    if (options_.dry_run) return Print(SuiteAblationText(suite));
    for (const SceneCheck& check : suite.checks) {
      if (!check.problem.empty()) listener(Warning{check.problem});
    }
    PrintResult(SideBySideText(RunSuiteAblation(ablation, suite, listener)), ablation.run.out / "ablation.md");
  }

  void PrintResult(const std::string& text, const std::filesystem::path& table) const {
    Print(text + fmt::format("table      {}", table.string()));
  }

  AblateOptions options_;
  std::string preset_;
};

}  // namespace

std::unique_ptr<Command> MakeAblate(CLI::App* app) { return std::make_unique<AblateCommand>(app); }

}  // namespace oraclegs
