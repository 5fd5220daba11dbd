#include "command.h"
#include "export_one.h"

namespace oraclegs {
namespace {

struct ExportFile {
  std::filesystem::path out;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    static const std::string help = "The file to write: " + SplatExtensions();
    visit("out", self.out, help.c_str());
  }
};

class ExportCommand : public Command {
 public:
  explicit ExportCommand(CLI::App* app)
      : Command(app, "export",
                "The splat for other programs: another format, fewer Gaussians, a part, another up or size",
                "oraclegs export out/ -o scene.spz --min-support 0.25 --crop auto --up auto") {
    BindInput("input", &input_, "Workspace of a run, or a splat of any of these formats");
    Bind("Output", &file_);
    Bind("Edits", &options_);
  }

 private:
  void Body(const Listener& listener) override {
    RequireOut(file_.out);
    Print(LineOf(file_.out, ExportOne(input_, file_.out, options_, listener)));
  }

  std::filesystem::path input_;
  ExportFile file_;
  ExportOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeExport(CLI::App* app) { return std::make_unique<ExportCommand>(app); }

}  // namespace oraclegs
