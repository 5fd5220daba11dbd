#include "oraclegs/pipeline/stages/prepare.h"
#include "oraclegs/pipeline/stages/validate_stage.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class ValidateCommand : public WorkspaceCommand {
 public:
  explicit ValidateCommand(CLI::App* app)
      : WorkspaceCommand(app, "validate", "How far each pixel of the proposals can be trusted",
                         "oraclegs validate scene/ -o out/ --views 12") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    const Preparation prepared = Prepare(&run);
    const ProposalPlan plan = RunPropose(&run, prepared.photos, prepared.geometry, prepared.decided);
    for (const TrainView& view : RunValidate(&run, prepared.photos, prepared.geometry, plan)) {
      Print(fmt::format("{:<24} {:5.1f} % trusted", view.name, 100 * view.confidence.mean().item<double>()));
    }
    Print(fmt::format("pictures   {}", (run.workspace.confidence() / "preview").string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakeValidate(CLI::App* app) { return std::make_unique<ValidateCommand>(app); }

}  // namespace oraclegs
