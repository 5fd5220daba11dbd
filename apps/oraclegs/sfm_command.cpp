#include "oraclegs/core/text.h"
#include "oraclegs/run/stages.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class SfmCommand : public WorkspaceCommand {
 public:
  explicit SfmCommand(CLI::App* app)
      : WorkspaceCommand(app, "sfm", "Structure from motion (COLMAP): camera poses and a sparse point cloud",
                         "oraclegs sfm photos/ -o out/ --views 12") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    RunStage(&run, "sfm");
    Print(fmt::format("sfm        {} from {}\nworkspace  {}", Counted(run.results->points.size(), "point"),
                      Counted(run.split.train.size(), "training view"), request.out.string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakeSfm(CLI::App* app) { return std::make_unique<SfmCommand>(app); }

}  // namespace oraclegs
