#include "oraclegs/output/cameras.h"
#include "oraclegs/run/reconstruct.h"

#include "oraclegs/core/text.h"
#include "source_command.h"

namespace oraclegs {
namespace {

class CamerasCommand : public Command {
 public:
  explicit CamerasCommand(CLI::App* app)
      : Command(app, "cameras",
                "The cameras and undistorted images of a run for other trainers: COLMAP model and transforms.json",
                "oraclegs cameras out/ -o dataset/") {
    BindInput("input", &input_, "Workspace of a run, or a scene folder with poses");
    Bind("Output", &out_);
    Bind("Scene", &options_.input, Level::kAdvanced);
    Bind("Split", &options_.split, Level::kAdvanced);
    Bind("Images", &options_.image);
  }

 private:
  void Body(const Listener& listener) override {
    RequireOut(out_.out);
    const CameraDatasetResult made = IsWorkspace(input_) ? OfWorkspace(listener) : OfScene(listener);
    Print(
        fmt::format("dataset    {} ({} images, {} points; COLMAP model in sparse/0, transforms.json)\n"
                    "to train   oraclegs reconstruct {} -o OUT",
                    out_.out.string(), made.images, made.points, ShellQuoted(out_.out.string())));
  }

  CameraDatasetResult OfWorkspace(const Listener& listener) {
    const CommandInfo info = Info();
    for (const auto& [list, tier] :
         {std::pair{&info.options, Tier::kFlag}, std::pair{&info.settings, Tier::kSetting}}) {
      for (const OptionInfo& option : *list) {
        const bool of_scene = option.group == "Scene" || option.group == "Split" || option.group == "Images";
        if (!of_scene || option.name == "max-size" || !table().IsGiven(option.name)) continue;
        throw UsageError("{}: a workspace has its own; leave the option out, or name the scene folder",
                         OptionShown(tier, option.name));
      }
    }
    oraclegs::Run run = OpenRunAsSaved(input_, {}, {}, listener);
    if (!options_.image.max_size.is_auto()) run.plan.image.max_size = options_.image.max_size.value();
    return WriteCameraDataset({run.scene, run.split, run.plan.image, SparsePointsOf(&run), run.frame}, out_.out,
                              listener);
  }

  CameraDatasetResult OfScene(const Listener& listener) const {
    CheckRunOptions(options_);
    const PosedScene posed = ReadPosedScene(input_, options_, listener);
    RequireOutsideScene(out_.out, posed.scene, options_.input.images);
    return WriteCameraDataset({posed.scene, posed.split, options_.image.Settled(), posed.scene.points, posed.frame},
                              out_.out, listener);
  }

  std::filesystem::path input_;
  OutOptions out_;
  RunOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeCameras(CLI::App* app) { return std::make_unique<CamerasCommand>(app); }

}  // namespace oraclegs
