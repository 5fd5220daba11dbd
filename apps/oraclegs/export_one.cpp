#include "export_one.h"

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/output/format_loss.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/workspace/stage_records.h"
#include "oraclegs/workspace/workspace.h"
#include "source_command.h"

namespace oraclegs {
namespace {

constexpr double kUsualScore = 30;  // dB; of what loses are said

ExportCameras CamerasOf(const std::filesystem::path& workspace, const Listener& listener) {
  const oraclegs::Run run = OpenRunAsSaved(workspace, {}, {}, listener);
  std::vector<Camera> cameras = WorkingCameras(run.scene, run.split.train, run.plan.image);
  for (Camera& camera : cameras) camera.cam_from_world = Moved(camera.cam_from_world, WrittenFromRun(run.frame));
  return {LookedAt(cameras), MeanUp(cameras)};
}

}  // namespace

ExportResult ExportOne(const std::filesystem::path& input, const std::filesystem::path& out,
                       const ExportOptions& options, const Listener& listener) {
  const bool workspace = IsWorkspace(input);
  const auto splat = workspace ? WorkspacePaths(input).point_cloud() : input;
  std::error_code ignored;
  if (!workspace && std::filesystem::is_directory(input, ignored) && !IsSplatFolder(input)) {
    throw InputError(
        "{}: holds no run of oraclegs; name the workspace of a run (its -o), or a splat file; `oraclegs convert` takes "
        "a folder of splats",
        input.string());
  }
  CheckExport({splat, out}, options);
  if (workspace) RequireOutsideScene(std::filesystem::absolute(out).parent_path(), ReadSavedRun(input).scene);
  if (workspace) WarnOfUnfinished(input, listener);
  std::optional<ExportCameras> cameras;
  // An up of the user's choice goes by the cameras where there are any; nothing else asks for them.
  if (workspace && (NeedsCameras(options) || !options.up.empty())) cameras = CamerasOf(input, listener);
  return ExportSplat({splat, out}, options, cameras, listener);
}

std::string LineOf(const std::filesystem::path& out, const ExportResult& result) {
  const double loss = LossOfScore(kUsualScore, result.psnr);
  return fmt::format(
      "splat      {} ({}, {:.2f} MB, {} of {} Gaussians, SH degree {}; {})", out.string(), result.extension,
      static_cast<double>(result.bytes) / 1e6, result.after, result.before, result.sh_degree,
      loss < 0.005 ? "loses nothing that is seen" : fmt::format("loses {:.2f} dB of {} dB", loss, kUsualScore));
}

}  // namespace oraclegs
