#include "oraclegs/pipeline/stages/depth_stage.h"
#include "oraclegs/pipeline/stages/start_points.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class DepthCommand : public WorkspaceCommand {
 public:
  explicit DepthCommand(CLI::App* app)
      : WorkspaceCommand(app, "depth", "Depth of every training photograph by multi-view stereo, and a dense cloud",
                         "oraclegs depth scene/ -o out/ --views 12") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    oraclegs::Run run = StartRun(request, listener);
    const std::vector<ScenePoint> points = RunSfm(&run);
    const std::vector<LoadedView> photos = LoadViews(run.scene, run.split.train, run.options.photo, listener);
    const Geometry geometry = RunDepth(&run, photos, points);
    for (const DepthMap& map : geometry.maps) {
      Print(fmt::format("{:<24} {:5.1f} % confident", map.name, 100 * ConfidentShare(map)));
    }
    Print(fmt::format("dense      {} points in {}\npictures   {}", geometry.points.size(),
                      run.workspace.dense_ply().string(), (run.workspace.depth() / "preview").string()));
  }
};

}  // namespace

std::unique_ptr<Command> MakeDepth(CLI::App* app) { return std::make_unique<DepthCommand>(app); }

}  // namespace oraclegs
