#include "command.h"
#include "oraclegs/pipeline/export.h"
#include "oraclegs/pipeline/workspace/workspace.h"

namespace oraclegs {
namespace {

struct ExportFile {
  std::filesystem::path out;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("out", self.out, "The .ply file to write");
  }
};

class ExportCommand : public Command {
 public:
  explicit ExportCommand(CLI::App* app)
      : Command(app, "export", "Write a smaller .ply: fewer Gaussians, lower degree of view-dependent colour",
                "oraclegs export out/ -o small.ply --sh-degree 1 --min-opacity 0.02") {
    BindInput("input", &input_, "Workspace of a run, or a .ply of any 3DGS trainer");
    Bind("Output", &file_);
    Bind("Model", &options_);
  }

 private:
  void Body(const Listener& listener) override {
    RequireOut(file_.out);
    const auto ply = IsWorkspace(input_) ? WorkspacePaths(input_).point_cloud() : input_;
    const ExportResult result = ExportPly(ply, file_.out, options_);
    listener(FileWritten{file_.out});
    Print(fmt::format("splat      {} ({} of {} Gaussians, SH degree {})", file_.out.string(), result.after,
                      result.before, result.sh_degree));
  }

  std::filesystem::path input_;
  ExportFile file_;
  ExportOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeExport(CLI::App* app) { return std::make_unique<ExportCommand>(app); }

}  // namespace oraclegs
