#include <nlohmann/json.hpp>

#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/workspace/stage_records.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

class ReconstructCommand : public WorkspaceCommand {
 public:
  explicit ReconstructCommand(CLI::App* app)
      : WorkspaceCommand(app, "reconstruct", "Photos in, splat and scores out: all stages in one run",
                         "oraclegs reconstruct photos/ -o out/", {.view = true}) {}

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    const nlohmann::json before = request.overwrite ? nlohmann::json::object() : ReadStageRecords(request.out);
    const nlohmann::json metrics = Reconstruct(request, listener);
    Print(StageTable(Stages(), before, ReadStageRecords(request.out)) + SummaryOf(metrics, request.out));
  }
};

}  // namespace

std::unique_ptr<Command> MakeReconstruct(CLI::App* app) { return std::make_unique<ReconstructCommand>(app); }

}  // namespace oraclegs
