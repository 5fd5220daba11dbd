#include "oraclegs/experiments/ablation_suite.h"
#include "oraclegs/experiments/layer_sweep.h"
#include "oraclegs/experiments/tampering.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class AblateCommand : public WorkspaceCommand {
 public:
  explicit AblateCommand(CLI::App* app)
      : WorkspaceCommand(app, "ablate", "Ablation study: add one component at a time and tabulate the gain",
                         "oraclegs ablate scene/ -o out/ --views 12 --seeds 3 --also other/\n"
                         "  oraclegs ablate scene/ -o out/ --views 12 --suite tampering\n"
                         "  oraclegs ablate scene/ -o out/ --views 12 --suite layers") {
    Bind("Ablation", &options_);
  }

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    RunRequest one = request;
    one.scene = OneFolder(request);
    one.inputs.clear();
    const AblationRequest ablation{one, options_, CommandLine()};
    if (options_.suite == AblationSuite::kLayers) {
      return Show(LayerSweepText(RunLayerSweep(ablation, listener)), request.out / "layers.md");
    }
    if (options_.suite == AblationSuite::kTampering) {
      if (!options_.also.empty()) throw UsageError("--also goes with --suite parts; leave it out");
      return Show(TamperingText(RunTampering(ablation, listener)), request.out / "tampering.md");
    }
    Show(AblationText(options_.also.empty() ? RunAblation(ablation, listener) : RunSuite(ablation, listener)),
         request.out / "ablation.md");
  }

  static void Show(const std::string& text, const std::filesystem::path& table) {
    Print(text + fmt::format("table      {}", table.string()));
  }

  AblateOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeAblate(CLI::App* app) { return std::make_unique<AblateCommand>(app); }

}  // namespace oraclegs
