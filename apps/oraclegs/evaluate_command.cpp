#include "oraclegs/core/text.h"
#include "oraclegs/output/evaluate_ply.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/stages/metrics.h"
#include "source_command.h"

namespace oraclegs {
namespace {

struct EvaluateOptions {
  bool oracle = false;
  bool uncertainty = false;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("check-oracle", self.oracle,
          "Instead measure how right the confidence of the run's proposals is, on images taken from their poses "
          "that neither train nor test (--trajectory dataset)");
    visit("check-uncertainty", self.uncertainty,
          "Print how well the error to expect of each pixel predicts the true errors at the test views, as "
          "metrics.json has it");
  }
};

std::string Shown(const nlohmann::json& number) {
  return number.is_number() ? fmt::format("{:.3f}", number.get<double>()) : "not known";
}

/// How well confidence orders the pixels by their error: a line for pixels and one for blocks of each oracle.
std::string OracleSummary(const nlohmann::json& report, const std::filesystem::path& workspace) {
  std::string text = fmt::format("proposals  PSNR {:.2f} dB, mean of {} views with an image\n",
                                 report.at("psnr").get<double>(), report.at("views").get<int>());
  for (const char* name : {"oracle", "uniform"}) {
    const nlohmann::json &q = report.at(name), &blocks = q.at("blocks");
    text += fmt::format(
        "{:<10} AUROC {} (error above the median) {} (above 0.1), AUSE {} of random, Spearman {}, reliability {}\n",
        name, Shown(q.at("auroc_above_median")), Shown(q.at("auroc_large_error")), Shown(q.at("ause_ratio")),
        Shown(q.at("spearman")), q.at("monotone").get<bool>() ? "monotone" : "not monotone");
    text += fmt::format(
        "           blocks of 8 x 8: AUROC {} (RMS error above 0.05), Spearman {}; calibration error {}\n",
        Shown(blocks.at("auroc_large_error")), Shown(blocks.at("spearman")), Shown(q.at("calibration_error")));
  }
  for (const nlohmann::json& bin : report.at("oracle").at("reliability")) {
    text += fmt::format("  confidence {:.2f}: similarity {:.2f}, error {:.3f}, {:.1f} % of the pixels\n",
                        bin.at("confidence").get<double>(), bin.at("similarity").get<double>(),
                        bin.at("error").get<double>(), 100 * bin.at("share").get<double>());
  }
  return text + fmt::format("report     {}", (workspace / "oracle.json").string());
}

std::string InTable(const nlohmann::json& number) { return number.is_number() ? Shown(number) : "-"; }

/// A column of the table of several workspaces.
struct QualityColumn {
  const char* head;
  nlohmann::json::json_pointer value;  ///< within a report
};
using Pointer = nlohmann::json::json_pointer;

const std::vector<QualityColumn>& OracleColumns() {
  static const std::vector<QualityColumn> columns = {{"block Spearman", Pointer("/oracle/blocks/spearman")},
                                                     {"block AUROC", Pointer("/oracle/blocks/auroc_large_error")},
                                                     {"AUROC > 0.1", Pointer("/oracle/auroc_large_error")},
                                                     {"AUROC > median", Pointer("/oracle/auroc_above_median")},
                                                     {"Spearman", Pointer("/oracle/spearman")},
                                                     {"AUSE of random", Pointer("/oracle/ause_ratio")},
                                                     {"calibration error", Pointer("/oracle/calibration_error")},
                                                     {"AUSE MAE", Pointer("/oracle/published_ause/images/mae")},
                                                     {"RMSE", Pointer("/oracle/published_ause/images/rmse")},
                                                     {"DSSIM", Pointer("/oracle/published_ause/images/dssim")}};
  return columns;
}

const std::vector<QualityColumn>& UncertaintyColumns() {
  static const std::vector<QualityColumn> columns = {{"AUROC > 0.1", Pointer("/models/auroc_large_error")},
                                                     {"of Gaussians", Pointer("/gaussians/auroc_large_error")},
                                                     {"Spearman", Pointer("/models/spearman")},
                                                     {"AUSE of random", Pointer("/models/ause_ratio")},
                                                     {"calibration error", Pointer("/models/calibration_error")},
                                                     {"AUSE MAE", Pointer("/models/published_ause/images/mae")},
                                                     {"RMSE", Pointer("/models/published_ause/images/rmse")},
                                                     {"DSSIM", Pointer("/models/published_ause/images/dssim")}};
  return columns;
}

nlohmann::json ValueIn(const nlohmann::json& report, const Pointer& at) {
  return report.contains(at) ? report.at(at) : nlohmann::json();
}

/// A line for each workspace, and the mean of what is known.
std::string QualityTable(const std::vector<std::filesystem::path>& workspaces,
                         const std::vector<nlohmann::json>& reports, const std::vector<QualityColumn>& columns) {
  std::vector<std::vector<std::string>> lines = {{"workspace"}};
  for (const QualityColumn& column : columns) lines[0].emplace_back(column.head);
  for (size_t w = 0; w < workspaces.size(); ++w) {
    lines.push_back({workspaces[w].string()});
    for (const QualityColumn& column : columns) lines.back().push_back(InTable(ValueIn(reports[w], column.value)));
  }
  lines.push_back({"mean"});
  for (const QualityColumn& column : columns) {
    double sum = 0, count = 0;
    for (const nlohmann::json& report : reports) {
      const nlohmann::json value = ValueIn(report, column.value);
      if (value.is_number()) sum += value.get<double>(), ++count;
    }
    lines.back().push_back(InTable(count > 0 ? nlohmann::json(sum / count) : nlohmann::json()));
  }
  if (workspaces.size() == 1) lines.pop_back();
  std::string text = AlignColumns(lines, "l" + std::string(columns.size(), 'r'));
  text.pop_back();  // printing ends the last line
  return text;
}

class EvaluateCommand : public SourceCommand {
 public:
  explicit EvaluateCommand(CLI::App* app)
      : SourceCommand(
            app, "evaluate", "Score a run, or any trainer's .ply, on the test views",
            "oraclegs evaluate out/\n  oraclegs evaluate scene/ --ply other.ply -o scores/ --downscale 2\n  oraclegs "
            "evaluate out/ --check-oracle\n  oraclegs evaluate out1/ out2/ --check-uncertainty") {
    this->app()
        ->add_option("others", others_, "Workspaces of more runs, with --check-oracle or --check-uncertainty")
        ->type_name("PATH")
        ->configurable(false);
    Bind("Oracle", &evaluate_);
  }

 private:
  /// Holds out test views of a scene without a run, too, since scores need them.
  void ApplyDefaults() override {
    SourceCommand::ApplyDefaults();
    if (!InputIsWorkspace() && !table().IsGiven("eval")) options_.split.eval = true;
  }

  void Body(const Listener& listener) override {
    if (evaluate_.oracle && evaluate_.uncertainty) throw UsageError("give one of --check-oracle, --check-uncertainty");
    const bool checks = evaluate_.oracle || evaluate_.uncertainty;
    const char* flag = evaluate_.oracle ? "--check-oracle" : "--check-uncertainty";
    if (checks && !InputIsWorkspace()) throw UsageError("{} needs the workspace of a run", flag);
    if (checks && !model_.ply.empty()) throw UsageError("{} measures a run, not a --ply", flag);
    if (!others_.empty() && !checks) {
      throw UsageError("several workspaces go with --check-oracle or --check-uncertainty; name one");
    }
    if (evaluate_.uncertainty || !others_.empty()) return Print(CheckAll(listener));
    if (!model_.ply.empty()) {
      const PosedScene posed = OpenScene(listener);
      const EvaluateRequest request{model_.ply, options_, out_.out, ORACLEGS_VERSION};
      return Print(SummaryOf(EvaluatePly(request, posed, listener), out_.out));
    }
    if (!out_.out.empty()) throw UsageError("-o goes with --ply; a run's own scores are written to its workspace");
    auto run = OpenRunOfInput(listener);
    if (evaluate_.oracle) return Print(OracleSummary(ReportOracle(*run), input_));
    EvaluateRun(&*run);
    Print(SummaryOf(ReadMetrics(input_), input_));
  }

  /// The uncertainty's quality, of scores that are of today's files.
  nlohmann::json UncertaintyOf(const std::filesystem::path& workspace, const Listener& listener) const {
    oraclegs::Run run = OpenSavedRun(workspace, listener);
    EvaluateRun(&run);
    nlohmann::json quality = ReadMetrics(workspace).value("uncertainty", nlohmann::json());
    if (!quality.is_object() || !quality.contains("models")) {
      throw InputError(
          "{}: nothing is known of its uncertainty; that needs test views and a model that this program trained",
          workspace.string());
    }
    return quality;
  }

  std::string CheckAll(const Listener& listener) const {
    std::vector<std::filesystem::path> workspaces = {input_};
    workspaces.insert(workspaces.end(), others_.begin(), others_.end());
    std::vector<nlohmann::json> reports;
    for (const auto& workspace : workspaces) {
      reports.push_back(evaluate_.oracle ? ReportOracle(OpenSavedRun(workspace, listener))
                                         : UncertaintyOf(workspace, listener));
    }
    return QualityTable(workspaces, reports, evaluate_.oracle ? OracleColumns() : UncertaintyColumns());
  }

  EvaluateOptions evaluate_;
  std::vector<std::string> others_;
};

}  // namespace

std::unique_ptr<Command> MakeEvaluate(CLI::App* app) { return std::make_unique<EvaluateCommand>(app); }

}  // namespace oraclegs
