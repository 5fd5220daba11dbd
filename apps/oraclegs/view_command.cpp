#include "command.h"
#include "oraclegs/output/view/view_source.h"
#include "viewing.h"

namespace oraclegs {
namespace {

class ViewCommand : public Command {
 public:
  explicit ViewCommand(CLI::App* app)
      : Command(app, "view", "Show a run or a splat in the browser: also while it is trained", "oraclegs view out/") {
    BindInput("input", &input_, "Workspace of a run, finished or going on, or a splat file of any format");
    Bind("Viewer", &options_);
  }

 private:
  void Body(const Listener& listener) override {
    const ViewSource source(input_, listener);
    const Viewing viewing(source.root(), options_, listener);
    Print(fmt::format("shows      {}; Ctrl-C ends it", source.what()));
    viewing.Wait();
  }

  std::filesystem::path input_;
  ViewerOptions options_;
};

}  // namespace

std::unique_ptr<Command> MakeView(CLI::App* app) { return std::make_unique<ViewCommand>(app); }

}  // namespace oraclegs
