#include "oraclegs/output/render_path.h"
#include "oraclegs/output/report/value_images.h"
#include "oraclegs/workspace/stage_records.h"
#include "source_command.h"

namespace oraclegs {
namespace {

class RenderCommand : public SourceCommand {
 public:
  explicit RenderCommand(CLI::App* app)
      : SourceCommand(app, "render", "Images (and a video when ffmpeg is installed) along a camera path",
                      "oraclegs render out/ --path spiral --what color,depth --frames 240") {
    Bind("Path", &path_);
  }

 private:
  void Body(const Listener& listener) override {
    ParseRenderValues(path_.what);  // before the point cloud is read
    std::filesystem::path out = out_.out;
    if (out.empty() && InputIsWorkspace()) out = WorkspacePaths(input_).renders(Word(path_.path));
    RequireOut(out);
    const PosedScene posed = OpenScene(listener);
    const auto ply = SplatFile(listener);
    const Device device = ChooseDevice(options_.device.device, ProbeDevices());
    Model model = LoadModel(ply, options_, device, posed.frame, listener);
    if (const WorkspacePaths run(input_); InputIsWorkspace() && ply == run.point_cloud()) {
      model.others = ModelsBeside(run, ReadStageRecords(run.root()).value("train", nlohmann::json()), device, listener);
    }
    RequireOutsideScene(out, posed.scene, options_.input.images);
    const auto cameras = PathCameras(posed, options_.image.Settled(), path_);
    const auto videos = RenderCameras(model, cameras, out, path_, listener);
    Print(fmt::format("images     {} in {}", cameras.size(), out.string()));
    for (const auto& video : videos) Print(fmt::format("video      {}", video.string()));
  }

  RenderPathOptions path_;
};

}  // namespace

std::unique_ptr<Command> MakeRender(CLI::App* app) { return std::make_unique<RenderCommand>(app); }

}  // namespace oraclegs
