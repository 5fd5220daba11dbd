#include "command.h"
#include "oraclegs/pipeline/start_points.h"

namespace oraclegs {
namespace {

class SfmCommand : public Command {
 public:
  explicit SfmCommand(CLI::App* app)
      : Command(app, "sfm", "Poses where there are none, and the points that training starts from",
                "oraclegs sfm photos/ -o out/ --views 12") {
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
    const StartPoints start = RunSfm(&run);
    Print(fmt::format("start      {} {} points for {} training views\nworkspace  {}", start.cloud.xyz.size(),
                      start.source, run.split.train.size(), request_.out.string()));
  }

  RunRequest request_;
  WorkspaceOptions workspace_;
};

}  // namespace

std::unique_ptr<Command> MakeSfm(CLI::App* app) { return std::make_unique<SfmCommand>(app); }

}  // namespace oraclegs
