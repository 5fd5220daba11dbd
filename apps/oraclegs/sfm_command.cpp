#include "oraclegs/pipeline/stages.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class SfmCommand : public WorkspaceCommand {
 public:
  explicit SfmCommand(CLI::App* app)
      : WorkspaceCommand(app, "sfm", "Poses where there are none, and the points that training starts from",
                         "oraclegs sfm photos/ -o out/ --views 12") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    RunStage(&run, "sfm");
    Print(fmt::format("sfm        {} points from {} training views\nworkspace  {}", run.results->points.size(),
                      run.split.train.size(), request.out.string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakeSfm(CLI::App* app) { return std::make_unique<SfmCommand>(app); }

}  // namespace oraclegs
