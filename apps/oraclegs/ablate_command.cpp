#include "oraclegs/experiments/ablation_suite.h"
#include "oraclegs/experiments/tampering.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class AblateCommand : public WorkspaceCommand {
 public:
  explicit AblateCommand(CLI::App* app)
      : WorkspaceCommand(app, "ablate", "Ablation study: add one component at a time and tabulate the gain",
                         "oraclegs ablate scene/ -o out/ --views 12 --seeds 3 --also other/\n"
                         "  oraclegs ablate scene/ -o out/ --views 12 --suite tampering") {
    Bind("Ablation", &options_);
  }

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    RunRequest one = request;
    one.scene = OneFolder(request);
    one.inputs.clear();
    const AblationRequest ablation{one, options_, CommandLine()};
    const bool tampering = options_.suite == AblationSuite::kTampering;
    if (tampering && !options_.also.empty()) throw UsageError("--also goes with --suite parts; leave it out");
    const auto parts = [&] {
      return options_.also.empty() ? RunAblation(ablation, listener) : RunSuite(ablation, listener);
    };
    Print((tampering ? TamperingText(RunTampering(ablation, listener)) : AblationText(parts())) +
          fmt::format("table      {}", (request.out / (tampering ? "tampering.md" : "ablation.md")).string()));
  }

  AblateOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeAblate(CLI::App* app) { return std::make_unique<AblateCommand>(app); }

}  // namespace oraclegs
