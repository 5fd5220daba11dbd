#include "oraclegs/output/figures/figure.h"
#include "source_command.h"

namespace oraclegs {
namespace {

class FigureCommand : public SourceCommand {
 public:
  explicit FigureCommand(CLI::App* app)
      : SourceCommand(
            app, "figure",
            "Figures of a paper as PNG and PDF: confidence of proposals, runs side by side, or methods and scenes "
            "of a benchmark",
            "oraclegs figure out/ -o confidence --rows 3\n  oraclegs figure out1/ out2/ -o crops --labels "
            "\"3DGS-MCMC,ours\" --crop 40,60,128,96\n  oraclegs figure bench/ -o grid") {
    this->app()
        ->add_option("others", others_, "Workspaces of more runs to compare")
        ->type_name("PATH")
        ->configurable(false);
    Bind("Figure", &figure_);
  }

 private:
  void ApplyDefaults() override {
    if (!IsSuiteFolder(input_)) SourceCommand::ApplyDefaults();
  }

  void Body(const Listener& listener) override {
    RequireOut(out_.out);
    const bool of_suite = IsSuiteFolder(input_);
    if (!of_suite && !InputIsWorkspace()) {
      throw UsageError("a figure needs the workspace of a run, or the folder of a benchmark; {} is neither",
                       input_.string());
    }
    if (of_suite && (!others_.empty() || !figure_.kind.is_auto())) {
      throw UsageError("{} is a benchmark, which is a figure of its own; leave out --kind and other folders",
                       input_.string());
    }
    std::vector<std::filesystem::path> workspaces = {input_};
    workspaces.insert(workspaces.end(), others_.begin(), others_.end());
    for (const auto& workspace : workspaces) {
      if (!of_suite && !IsWorkspace(workspace)) {
        throw InputError("{}: holds no run of oraclegs; name a workspace", workspace.string());
      }
    }
    const FigureKind usual = others_.empty() ? FigureKind::kConfidence : FigureKind::kComparison;
    const FigureKind kind = figure_.kind.ValueOr(usual);
    if (kind == FigureKind::kConfidence && !others_.empty()) {
      throw UsageError("--kind confidence shows one run; name one workspace");
    }
    if (!model_.ply.empty()) throw UsageError("a figure shows what is in the workspace; leave out --ply");
    std::filesystem::path stem = out_.out;
    if (!stem.has_filename() || std::filesystem::is_directory(stem)) {
      throw UsageError("-o {} is a folder; name the figure, for example {}", stem.string(), (stem / "figure").string());
    }
    if (stem.extension() == ".png" || stem.extension() == ".pdf") stem.replace_extension();
    const Sheet sheet = of_suite                          ? SuiteSheet(input_, figure_)
                        : kind == FigureKind::kConfidence ? ConfidenceSheet(*OpenRunOfInput(listener), figure_)
                                                          : ComparisonSheet(workspaces, figure_);
    const SheetFiles files = WriteSheet(sheet, stem, figure_.panel_width);
    Print(fmt::format("figure     {}, {}", files.png.string(), files.pdf.string()));
  }

  FigureOptions figure_;
  std::vector<std::string> others_;
};

}  // namespace

std::unique_ptr<Command> MakeFigure(CLI::App* app) { return std::make_unique<FigureCommand>(app); }

}  // namespace oraclegs
