#include "oraclegs/pipeline/reconstruct.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class ReconstructCommand : public WorkspaceCommand {
 public:
  explicit ReconstructCommand(CLI::App* app)
      : WorkspaceCommand(app, "reconstruct", "Photographs in, splat and scores out: sfm, train and evaluate in one run",
                         "oraclegs reconstruct photos/ -o out/ --views 12 --downscale 2") {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    Print(SummaryOf(Reconstruct(request, listener), request.out));
  }
};

}  // namespace

std::unique_ptr<Command> MakeReconstruct(CLI::App* app) { return std::make_unique<ReconstructCommand>(app); }

}  // namespace oraclegs
