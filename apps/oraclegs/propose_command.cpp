#include "oraclegs/pipeline/stages.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class ProposeCommand : public WorkspaceCommand {
 public:
  explicit ProposeCommand(CLI::App* app)
      : WorkspaceCommand(app, "propose", "Images of views that no photo was taken from, to be validated and trained on",
                         "oraclegs propose scene/ -o out/ --views 12 --trajectory interpolate --proposals 16") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    RunStage(&run, "propose");
    const StageResults& known = *run.results;
    Print(fmt::format("proposals  {} poses, {} proxy models, {} views from a folder\nimages     {}",
                      known.targets.size(), known.proxies.size(), known.folder.proposals.size(),
                      run.workspace.proposals().string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakePropose(CLI::App* app) { return std::make_unique<ProposeCommand>(app); }

}  // namespace oraclegs
