#include "oraclegs/camera/camera_path.h"
#include "oraclegs/mesh/fuse_model.h"
#include "oraclegs/mesh/isosurface.h"
#include "oraclegs/mesh/triangle_mesh.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage_clock.h"
#include "source_command.h"

namespace oraclegs {
namespace {

class MeshCommand : public SourceCommand {
 public:
  explicit MeshCommand(CLI::App* app)
      : SourceCommand(app, "mesh", "A triangle mesh with colors, fused from the depth that the splat renders",
                      "oraclegs mesh out/ -o mesh.glb") {
    Bind("Mesh", &mesh_);
  }

 private:
  void Body(const Listener& listener) override {
    std::filesystem::path out = out_.out;
    if (out.empty() && InputIsWorkspace()) out = input_ / "mesh.ply";
    RequireOut(out);
    RequireMeshExtension(out);
    RequireIsosurface();
    const PosedScene posed = OpenScene(listener);
    const auto ply = SplatFile(listener);
    const Device device = ChooseDevice(options_.device.device, ProbeDevices());
    const Model model = LoadModel(ply, options_, device, posed.frame, listener);
    RequireOutsideScene(std::filesystem::absolute(out).parent_path(), posed.scene, options_.input.images);
    const std::vector<Camera> cameras = WorkingCameras(posed.scene, posed.split.train, options_.image.Settled());
    const std::optional<double> unit_meters = posed.frame.unit_meters ? posed.frame.unit_meters : model.unit_meters;
    const Similarity written_from_run = WrittenFromRun(posed.frame);
    mesh_.unit = written_from_run.scale * unit_meters.value_or(1);
    const StageClock clock("mesh", listener);
    FusedMesh fused = FuseModel(model.gaussians, model.render, cameras, mesh_, listener);
    if (fused.mesh.triangles.empty()) {
      throw InputError(
          "{}: its renders show no surface (opaque, of known depth) from the training views; train longer, or lower "
          "--min-part",
          ply.string());
    }
    const Eigen::Vector3d translation = written_from_run.translation * unit_meters.value_or(1);
    for (Eigen::Vector3f& position : fused.mesh.positions) {
      position = (position.cast<double>() + translation).cast<float>();
    }
    WriteMesh(out, fused.mesh, MeanUp(cameras), WithOffset({}, posed.frame.offset * unit_meters.value_or(1)));
    clock.Finish();
    listener(FileWritten{out});
    Print(fmt::format("mesh       {} ({} vertices, {} triangles, voxels of {:.3g}{})", out.string(),
                      fused.mesh.positions.size(), fused.mesh.triangles.size(), fused.voxel, unit_meters ? " m" : ""));
  }

  MeshOptions mesh_;
};

}  // namespace

std::unique_ptr<Command> MakeMesh(CLI::App* app) { return std::make_unique<MeshCommand>(app); }

}  // namespace oraclegs
