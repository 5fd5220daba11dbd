#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "command.h"
#include "config_file.h"
#include "oraclegs/core/text.h"
#include "oraclegs/experiments/bench/bench.h"
#include "oraclegs/experiments/bench/bench_report.h"
#include "oraclegs/experiments/bench/run_record.h"
#include "version.h"

namespace oraclegs {
namespace {

struct BenchOutput {
  std::filesystem::path out;
  bool overwrite = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("out", self.out,
          "Folder for tables, plots and a workspace of each run; the same command goes on there where it was stopped");
    visit("overwrite", self.overwrite, "Start anew: remove what earlier runs of this command left there");
  }
};

class BenchCommand : public Command {
 public:
  explicit BenchCommand(CLI::App* app)
      : Command(app, "bench", "Benchmark suite: methods on scenes, numbers of views and seeds, as tables and plots",
                "oraclegs bench --suite blender --data datasets/ -o out/ --methods ours,3dgs-mcmc --dry-run\n"
                "  oraclegs bench --suite my-scenes/ -o out/ --views 6,12 --seeds 1 --iterations 3000") {
    Bind("Benchmark", &options_);
    Bind("Slurm", &slurm_, Level::kAdvanced);
    Bind("Output", &output_);
    BindRun(&run_);
  }

 private:
  bool ComputesHere() const override { return options_.launcher == LauncherKind::kLocal; }

  void Body(const Listener& listener) override {
    BenchRequest request;
    request.options = options_, request.first_seed = run_.start.seed;
    request.asked = Asked(), request.preset = preset_, request.read_preset = PresetArguments;
    request.out = output_.out, request.overwrite = output_.overwrite;
    request.command = CommandLine(), request.version = fmt::format("{} ({})", ORACLEGS_VERSION, CommitText());
    request.program = std::filesystem::read_symlink("/proc/self/exe");
    if (options_.dry_run && request.out.empty()) request.out = "out";
    RequireOut(request.out);
    const LaunchOptions launch = {options_.workers, run_.device.device, slurm_,
                                  std::filesystem::absolute(request.out) / kSlurmFolder};
    request.workers = options_.launcher == LauncherKind::kLocal ? LocalWorkerCount(launch) : 0;
    ShareThreads(&request);
    const BenchPlan plan = PlanBench(request);
    if (options_.dry_run) return Print(PlanText(request, plan));
    for (const SceneCheck& check : plan.checks) {
      if (!check.problem.empty()) listener(Warning{check.problem});
    }
    const auto launcher = MakeLauncher(options_.launcher, launch);
    Print(BenchText(RunBench(request, plan, launcher.get(), listener)) +
          fmt::format("table      {}", (request.out / "bench.md").string()));
  }

  void TakePreset(const std::string& name) override {
    if (name == "paper") {
      throw UsageError(
          "--preset paper is for scenes of no dataset; --methods paper has the paper's settings for each suite and "
          "number "
          "of views");
    }
    preset_ = PresetArguments(name);
  }

  /// The options of runs that the command line or a file has set, whose seeds are the benchmark's own.
  RunArguments Asked() {
    const nlohmann::json own = OptionsToJson(options_);  // --views is a list there
    RunArguments asked = GivenArguments(table(), run_);
    std::erase_if(asked, [&](const auto& option) { return option.first == "seed" || own.contains(option.first); });
    return asked;
  }

  /// Runs at once must not each take all cores; how many they take changes no result.
  static void ShareThreads(BenchRequest* request) {
    if (request->workers < 2 || FindArgument(request->asked, "threads")) return;
    const int cores = static_cast<int>(std::thread::hardware_concurrency());
    request->asked.emplace_back("threads", std::to_string(std::max(1, cores / request->workers)));
  }

  BenchOptions options_;
  SlurmOptions slurm_;
  BenchOutput output_;
  RunOptions run_;
  RunArguments preset_;
};

}  // namespace

std::unique_ptr<Command> MakeBench(CLI::App* app) { return std::make_unique<BenchCommand>(app); }

}  // namespace oraclegs
