#include "oraclegs/experiments/layer_sweep.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/train/train_view.h"
#include "workspace_command.h"

namespace oraclegs {
namespace {

struct SweepOptions {
  bool each_layer = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("each-layer", self.each_layer,
          "Instead measure how well the attention of each layer of VGGT alone predicts where proposals are wrong, on "
          "images taken from their poses that neither train nor test");
  }
};

class ValidateCommand : public WorkspaceCommand {
 public:
  explicit ValidateCommand(CLI::App* app)
      : WorkspaceCommand(app, "validate", "Estimate a confidence map for every proposed view",
                         "oraclegs validate scene/ -o out/ --views 12\n"
                         "  oraclegs validate scene/ -o layers/ --views 12 --each-layer") {
    Bind("Layers", &sweep_);
  }

 private:
  void Fill(const RunRequest& request, const Listener& listener) override {
    if (sweep_.each_layer) return Sweep(request, listener);
    oraclegs::Run run = StartRun(request, listener);
    RunStage(&run, "validate");
    for (const TrainView& view : run.results->proposals) {
      Print(fmt::format("{:<24} mean confidence {:.3f}", view.name, MeanConfidence(view)));
    }
    Print(fmt::format("images     {}", (run.workspace.confidence() / "preview").string()));
  }

  void Sweep(const RunRequest& request, const Listener& listener) const {
    RunRequest one = request;
    one.scene = OneFolder(request);
    one.inputs.clear();
    Print(LayerSweepText(RunLayerSweep(one, CommandLine(), listener)) +
          fmt::format("table      {}", (request.out / "layers.md").string()));
  }

  SweepOptions sweep_;
};

}  // namespace

std::unique_ptr<Command> MakeValidate(CLI::App* app) { return std::make_unique<ValidateCommand>(app); }

}  // namespace oraclegs
