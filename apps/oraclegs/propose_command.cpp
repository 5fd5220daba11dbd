#include "oraclegs/pipeline/stages/prepare.h"
#include "oraclegs/pipeline/stages/propose_stage.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class ProposeCommand : public WorkspaceCommand {
 public:
  explicit ProposeCommand(CLI::App* app)
      : WorkspaceCommand(app, "propose", "Pictures of views nobody photographed, to be validated and trained on",
                         "oraclegs propose scene/ -o out/ --views 12 --trajectory interpolate --proposals 16") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    const Preparation prepared = Prepare(&run);
    const ProposalPlan plan = RunPropose(&run, prepared.photos, prepared.geometry, prepared.decided);
    Print(fmt::format("proposals  {} poses, {} quick models, {} views from a folder\npictures   {}",
                      plan.targets.size(), plan.opinions.size(), plan.folder.proposals.size(),
                      run.workspace.proposals().string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakePropose(CLI::App* app) { return std::make_unique<ProposeCommand>(app); }

}  // namespace oraclegs
