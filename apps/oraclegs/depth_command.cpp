#include "oraclegs/run/stages.h"
#include "oraclegs/stages/stage_works.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class DepthCommand : public WorkspaceCommand {
 public:
  explicit DepthCommand(CLI::App* app)
      : WorkspaceCommand(app, "depth", "Multi-view stereo: a depth map of every training view and a dense point cloud",
                         "oraclegs depth scene/ -o out/ --views 12") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    RequireDepth(&run);
    RunStage(&run, "depth");
    const Geometry& geometry = run.results->geometry;
    for (const DepthMap& map : geometry.maps) {
      Print(fmt::format("{:<24} {:5.1f} % confident", map.name, 100 * ConfidentShare(map)));
    }
    Print(fmt::format("dense      {} points in {}\nimages     {}", geometry.points.size(),
                      run.workspace.dense_ply().string(), (run.workspace.depth() / "preview").string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakeDepth(CLI::App* app) { return std::make_unique<DepthCommand>(app); }

}  // namespace oraclegs
