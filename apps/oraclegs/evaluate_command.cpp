#include "oraclegs/pipeline/evaluate_ply.h"
#include "oraclegs/pipeline/reconstruct.h"
#include "oraclegs/pipeline/stages/metrics.h"
#include "oraclegs/pipeline/stages/oracle_report.h"
#include "source_command.h"

namespace oraclegs {
namespace {

struct EvaluateOptions {
  bool oracle = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("check-oracle", self.oracle,
          "Instead measure how right the confidence of the run's proposals is, on images taken from their poses "
          "that neither train nor test (--trajectory dataset)");
  }
};

std::string Shown(const nlohmann::json& number) {
  return number.is_number() ? fmt::format("{:.3f}", number.get<double>()) : "not known";
}

/// One line for each oracle: how well its confidence orders the pixels by their error.
std::string OracleSummary(const nlohmann::json& report, const std::filesystem::path& workspace) {
  std::string text = fmt::format("proposals  PSNR {:.2f} dB, mean of {} views with an image\n",
                                 report.at("psnr").get<double>(), report.at("views").get<int>());
  for (const char* name : {"oracle", "uniform"}) {
    const nlohmann::json& q = report.at(name);
    text += fmt::format(
        "{:<10} AUROC {} (error above the median) {} (above 0.1), AUSE {} of random, Spearman {}, reliability {}\n",
        name, Shown(q.at("auroc_above_median")), Shown(q.at("auroc_large_error")), Shown(q.at("ause_ratio")),
        Shown(q.at("spearman")), q.at("monotone").get<bool>() ? "monotone" : "not monotone");
  }
  for (const nlohmann::json& bin : report.at("oracle").at("reliability")) {
    text += fmt::format("  confidence {:.2f}: similarity {:.2f}, error {:.3f}, {:.1f} % of the pixels\n",
                        bin.at("confidence").get<double>(), bin.at("similarity").get<double>(),
                        bin.at("error").get<double>(), 100 * bin.at("share").get<double>());
  }
  return text + fmt::format("report     {}", (workspace / "oracle.json").string());
}

class EvaluateCommand : public SourceCommand {
 public:
  explicit EvaluateCommand(CLI::App* app)
      : SourceCommand(
            app, "evaluate", "Score a run, or any trainer's .ply, on the test views",
            "oraclegs evaluate out/\n  oraclegs evaluate scene/ --ply other.ply -o scores/ --downscale 2\n  oraclegs "
            "evaluate out/ --check-oracle") {
    Bind("Oracle", &evaluate_);
  }

 private:
  void Body(const Listener& listener) override {
    if (evaluate_.oracle && !InputIsWorkspace()) throw UsageError("--check-oracle needs the workspace of a run");
    if (evaluate_.oracle && !model_.ply.empty()) throw UsageError("--check-oracle measures proposals, not a --ply");
    if (!model_.ply.empty()) {
      const EvaluateRequest request{model_.ply, options_, out_.out, ORACLEGS_VERSION};
      return Print(SummaryOf(EvaluatePly(request, OpenScene(listener), listener), out_.out));
    }
    if (!out_.out.empty()) throw UsageError("-o goes with --ply; a run's own scores are written to its workspace");
    auto run = OpenRunOfInput(listener);
    if (evaluate_.oracle) return Print(OracleSummary(ReportOracle(*run), input_));
    EvaluateRun(&*run);
    Print(SummaryOf(ReadMetrics(input_), input_));
  }

  EvaluateOptions evaluate_;
};

}  // namespace

std::unique_ptr<Command> MakeEvaluate(CLI::App* app) { return std::make_unique<EvaluateCommand>(app); }

}  // namespace oraclegs
