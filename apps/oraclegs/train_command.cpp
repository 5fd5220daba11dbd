#include "oraclegs/run/stages.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class TrainCommand : public WorkspaceCommand {
 public:
  explicit TrainCommand(CLI::App* app)
      : WorkspaceCommand(app, "train", "Run all stages up to training; no evaluation",
                         "oraclegs train scene/ -o out/ --iterations 7000 --max-gaussians 100000", {.view = true}) {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    RunStage(&run, "train");
    Print(fmt::format("splat      {}", run.workspace.point_cloud().string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakeTrain(CLI::App* app) { return std::make_unique<TrainCommand>(app); }

}  // namespace oraclegs
