#include "oraclegs/camera/camera_path.h"
#include "oraclegs/formats/splat_file.h"
#include "oraclegs/output/export.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/workspace/stage_records.h"
#include "oraclegs/workspace/workspace.h"
#include "source_command.h"

namespace oraclegs {
namespace {

struct ExportFile {
  std::filesystem::path out;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    static const std::string help = "The file to write: " + SplatExtensions();
    visit("out", self.out, help.c_str());
  }
};

class ExportCommand : public Command {
 public:
  explicit ExportCommand(CLI::App* app)
      : Command(app, "export",
                "The splat for other programs: another format, fewer Gaussians, a part, another up or size",
                "oraclegs export out/ -o scene.spz --min-support 0.25 --crop auto --up auto") {
    BindInput("input", &input_, "Workspace of a run, or a splat of any of these formats");
    Bind("Output", &file_);
    Bind("Model", &options_);
  }

 private:
  void Body(const Listener& listener) override {
    RequireOut(file_.out);
    const bool workspace = IsWorkspace(input_);
    const auto splat = workspace ? WorkspacePaths(input_).point_cloud() : input_;
    std::error_code ignored;
    if (!workspace && std::filesystem::is_directory(input_, ignored) && !IsSplatFolder(input_)) {
      throw InputError("{}: holds no run of oraclegs; name the workspace of a run (its -o), or a splat file",
                       input_.string());
    }
    CheckExport({splat, file_.out}, options_);
    if (workspace) RequireOutsideScene(std::filesystem::absolute(file_.out).parent_path(), ReadSavedRun(input_).scene);
    if (workspace) WarnOfUnfinished(input_, listener);
    std::optional<ExportCameras> cameras;
    // An up of the user's choice goes by the cameras where there are any; nothing else asks for them.
    if (workspace && (NeedsCameras(options_) || !options_.up.empty())) cameras = CamerasOf(listener);
    const ExportResult result = ExportSplat({splat, file_.out}, options_, cameras, listener);
    Print(fmt::format("splat      {} ({}, {:.2f} MB, {} of {} Gaussians, SH degree {})", file_.out.string(),
                      result.extension, static_cast<double>(result.bytes) / 1e6, result.after, result.before,
                      result.sh_degree));
  }

  ExportCameras CamerasOf(const Listener& listener) const {
    const oraclegs::Run run = OpenRunAsSaved(input_, {}, {}, listener);
    std::vector<Camera> cameras = WorkingCameras(run.scene, run.split.train, run.plan.image);
    for (Camera& camera : cameras) camera.cam_from_world = Moved(camera.cam_from_world, WrittenFromRun(run.frame));
    return {LookedAt(cameras), MeanUp(cameras)};
  }

  std::filesystem::path input_;
  ExportFile file_;
  ExportOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeExport(CLI::App* app) { return std::make_unique<ExportCommand>(app); }

}  // namespace oraclegs
