#include "command.h"
#include "oraclegs/pipeline/reconstruct.h"

namespace oraclegs {
namespace {

class ReconstructCommand : public Command {
 public:
  explicit ReconstructCommand(CLI::App* app)
      : Command(app, "reconstruct", "Photographs in, splat and scores out: sfm, train and evaluate in one run",
                "oraclegs reconstruct photos/ -o out/ --views 12 --downscale 2") {
    BindInput("scene", &request_.scene,
              "Scene folder: photographs, a COLMAP model, transforms.json or a Blender scene; never written to");
    Bind("Output", &workspace_);
    BindRun(&request_.options);
  }

 private:
  void Body(const Listener& listener) override {
    RequireOut(workspace_.out);
    request_.out = workspace_.out;
    request_.overwrite = workspace_.overwrite;
    request_.version = ORACLEGS_VERSION;
    Print(SummaryOf(Reconstruct(request_, listener), request_.out));
  }

  RunRequest request_;
  WorkspaceOptions workspace_;
};

}  // namespace

std::unique_ptr<Command> MakeReconstruct(CLI::App* app) { return std::make_unique<ReconstructCommand>(app); }

}  // namespace oraclegs
