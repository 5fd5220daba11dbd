#include "command.h"
#include "oraclegs/pipeline/train_stage.h"

namespace oraclegs {
namespace {

class TrainCommand : public Command {
 public:
  explicit TrainCommand(CLI::App* app)
      : Command(app, "train", "Train the Gaussians (with sfm before it when needed), without scoring them",
                "oraclegs train scene/ -o out/ --iterations 7000 --max-gaussians 100000") {
    BindInput("scene", &request_.scene, "Scene folder; never written to");
    Bind("Output", &workspace_);
    BindRun(&request_.options);
  }

 private:
  void Body(const Listener& listener) override {
    RequireOut(workspace_.out);
    request_.out = workspace_.out;
    request_.overwrite = workspace_.overwrite;
    request_.version = ORACLEGS_VERSION;
    oraclegs::Run run = StartRun(request_, listener);
    RunTrain(&run);
    Print(fmt::format("splat      {}", run.workspace.point_cloud().string()));
  }

  RunRequest request_;
  WorkspaceOptions workspace_;
};

}  // namespace

std::unique_ptr<Command> MakeTrain(CLI::App* app) { return std::make_unique<TrainCommand>(app); }

}  // namespace oraclegs
