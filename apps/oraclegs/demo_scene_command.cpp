#include "command.h"
#include "oraclegs/demo/demo_scene.h"

namespace oraclegs {
namespace {

class DemoSceneCommand : public Command {
 public:
  explicit DemoSceneCommand(CLI::App* app)
      : Command(app, "demo-scene", "Write a small ray-traced scene with exact poses and depth, to try the program on",
                "oraclegs demo-scene /tmp/demo") {
    BindInput("dir", &dir_, "Folder to write the scene to; must be new or empty");
    Bind("Scene", &options_);
    BindMachine(&machine_);
  }

 private:
  void Body(const Listener& listener) override {
    WriteDemoScene(dir_, options_, listener);
    Print(fmt::format("scene      {}", dir_.string()));
  }

  std::filesystem::path dir_;
  DemoSceneOptions options_;
  MachineOptions machine_;
};

}  // namespace

std::unique_ptr<Command> MakeDemoScene(CLI::App* app) { return std::make_unique<DemoSceneCommand>(app); }

}  // namespace oraclegs
