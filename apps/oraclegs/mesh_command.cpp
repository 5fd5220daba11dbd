#include "oraclegs/camera/camera_path.h"
#include "oraclegs/gaussians/selection.h"
#include "oraclegs/mesh/fuse_model.h"
#include "oraclegs/mesh/isosurface.h"
#include "oraclegs/mesh/triangle_mesh.h"
#include "oraclegs/output/model_edits.h"
#include "oraclegs/scene/frame_comments.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/settings/device.h"
#include "oraclegs/stages/evaluate_stage.h"
#include "oraclegs/stages/stage_clock.h"
#include "source_command.h"

namespace oraclegs {
namespace {

constexpr int kUsualTexture = 4096;  // pixels

struct CropOptions {
  std::string crop;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("crop", self.crop, kCropHelp);
  }
};

/// Side of the texture of a file. Throws UsageError when one is asked for that the file does not hold.
int TextureFor(const std::filesystem::path& out, const Auto<int>& asked) {
  const int side = asked.ValueOr(HoldsTexture(out) ? kUsualTexture : 0);
  if (side == 0 || HoldsTexture(out)) return side;
  throw UsageError("--texture is {}: {} holds none; write a .glb or .obj, or leave it out", side, out.string());
}

/// The Gaussians, in the run's coordinates, that a crop in the scene's holds. Throws UsageError when there is none.
Gaussians Cropped(const Gaussians& gaussians, Crop crop, const SceneFrame& frame, const std::vector<Camera>& cameras) {
  if (crop.kind == Crop::Kind::kNone) return gaussians;
  Similarity crop_from_run = RunFromScene(frame).Inverse();
  if (crop.kind == Crop::Kind::kAuto) {
    crop.kind = Crop::Kind::kBall, crop.ball = LookedAt(cameras);
    crop_from_run = {};
  }
  const std::vector<int64_t> held = HeldBy(crop, gaussians, crop_from_run);
  if (held.empty()) {
    throw UsageError("--crop holds none of the {} Gaussians; crop less, in the coordinates of the scene",
                     gaussians.size());
  }
  return Picked(gaussians.To(kCpu), held).To(gaussians.device());
}

class MeshCommand : public SourceCommand {
 public:
  explicit MeshCommand(CLI::App* app)
      : SourceCommand(app, "mesh", "A triangle mesh with colors, fused from the depth that the splat renders",
                      "oraclegs mesh out/ -o mesh.glb") {
    Bind("Mesh", &mesh_);
    Bind("Mesh", &crop_);
  }

 private:
  void Body(const Listener& listener) override {
    std::filesystem::path out = out_.out;
    if (out.empty() && InputIsWorkspace()) out = input_ / "mesh.ply";
    RequireOut(out);
    RequireMeshExtension(out);
    CheckMesh(mesh_);
    mesh_.texture = TextureFor(out, mesh_.texture);
    const Crop crop = ParseCrop(crop_.crop);
    RequireIsosurface();
    const PosedScene posed = OpenScene(listener);
    const auto ply = SplatFile(listener);
    const Device device = ChooseDevice(options_.device.device, ProbeDevices());
    Model model = LoadModel(ply, options_, device, posed.frame, listener);
    RequireOutsideScene(std::filesystem::absolute(out).parent_path(), posed.scene, options_.input.images);
    const std::vector<Camera> cameras = WorkingCameras(posed.scene, posed.split.train, options_.image.Settled());
    model.gaussians = Cropped(model.gaussians, crop, posed.frame, cameras);
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
    const auto files =
        WriteMesh(out, fused.mesh, MeanUp(cameras), WithOffset({}, posed.frame.offset * unit_meters.value_or(1)));
    clock.Finish();
    for (const std::filesystem::path& file : files) listener(FileWritten{file});
    const int side = fused.mesh.texture.width;
    Print(fmt::format("mesh       {} ({} vertices, {} triangles, voxels of {:.3g}{}, {})", out.string(),
                      fused.mesh.positions.size(), fused.mesh.triangles.size(), fused.voxel, unit_meters ? " m" : "",
                      side > 0 ? fmt::format("a texture of {0} x {0} pixels", side) : "a color at each vertex"));
  }

  MeshOptions mesh_;
  CropOptions crop_;
};

}  // namespace

std::unique_ptr<Command> MakeMesh(CLI::App* app) { return std::make_unique<MeshCommand>(app); }

}  // namespace oraclegs
