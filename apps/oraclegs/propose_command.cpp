#include "oraclegs/core/text.h"
#include "oraclegs/run/stages.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class ProposeCommand : public WorkspaceCommand {
 public:
  explicit ProposeCommand(CLI::App* app)
      : WorkspaceCommand(app, "propose", "Synthesize new views (proposals) as extra training data",
                         "oraclegs propose scene/ -o out/ --views 12 --trajectory interpolate --proposals 16") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    RunStage(&run, "propose");
    const StageResults& known = *run.results;
    Print(fmt::format("proposals  {}, {}, {} from a folder\nimages     {}", Counted(known.targets.size(), "pose"),
                      Counted(known.proxies.size(), "proxy model"), Counted(known.folder.proposals.size(), "view"),
                      run.workspace.proposals().string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakePropose(CLI::App* app) { return std::make_unique<ProposeCommand>(app); }

}  // namespace oraclegs
