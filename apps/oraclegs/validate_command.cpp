#include "oraclegs/run/stages.h"
#include "oraclegs/train/train_view.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class ValidateCommand : public WorkspaceCommand {
 public:
  explicit ValidateCommand(CLI::App* app)
      : WorkspaceCommand(app, "validate", "Estimate a confidence map for every proposed view",
                         "oraclegs validate scene/ -o out/ --views 12") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    RunStage(&run, "validate");
    for (const TrainView& view : run.results->proposals) {
      Print(fmt::format("{:<24} mean confidence {:.3f}", view.name, MeanConfidence(view.pixel_weight)));
    }
    Print(fmt::format("images     {}", (run.workspace.confidence() / "preview").string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakeValidate(CLI::App* app) { return std::make_unique<ValidateCommand>(app); }

}  // namespace oraclegs
