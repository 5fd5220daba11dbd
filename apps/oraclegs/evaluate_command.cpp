#include "oraclegs/pipeline/evaluate_stage.h"
#include "oraclegs/pipeline/metrics.h"
#include "source_command.h"

namespace oraclegs {
namespace {

class EvaluateCommand : public SourceCommand {
 public:
  explicit EvaluateCommand(CLI::App* app)
      : SourceCommand(app, "evaluate", "Score a run, or any trainer's .ply, on the test views",
                      "oraclegs evaluate out/\n  oraclegs evaluate scene/ --ply other.ply -o scores/ --downscale 2") {}

 private:
  void Body(const Listener& listener) override {
    if (!model_.ply.empty()) {
      const EvaluateRequest request{model_.ply, options_, out_.out, ORACLEGS_VERSION};
      return Print(SummaryOf(EvaluatePly(request, OpenScene(listener), listener), out_.out));
    }
    if (!out_.out.empty()) throw UsageError("-o goes with --ply; a run's own scores are written to its workspace");
    auto run = OpenRunOfInput(listener);
    RunEvaluate(&*run);
    Print(SummaryOf(ReadMetrics(input_), input_));
  }
};

}  // namespace

std::unique_ptr<Command> MakeEvaluate(CLI::App* app) { return std::make_unique<EvaluateCommand>(app); }

}  // namespace oraclegs
