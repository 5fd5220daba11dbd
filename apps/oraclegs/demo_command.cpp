#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "command.h"
#include "oraclegs/demo/demo_scene.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/run/reconstruct.h"
#include "oraclegs/run/stages.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/workspace/stage_records.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

struct DemoOptions {
  fs::path out = "oraclegs-demo";
  bool overwrite = false;
  int views = 12;
  int iterations = 1500;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("out", self.out, "Folder for the scene and its reconstruction; a demo that was stopped there is continued");
    visit("overwrite", self.overwrite, "Reconstruct anew");
    visit("views", self.views, "Training views; every eighth of all is kept to compare with", Range{3, 100});
    visit("iterations", self.iterations, "Training steps; more give a sharper image and take longer", Range{1, 1e6});
  }
};

/// Two RGB images of one size beside each other, with a white line between them.
Image8 SideBySide(const Image8& left, const Image8& right) {
  constexpr int kLine = 4, kChannels = 3;
  Image8 both{left.width + kLine + right.width, left.height, kChannels, {}};
  both.data.reserve(static_cast<size_t>(both.width) * both.height * kChannels);
  const auto append_row = [&](const Image8& image, int y) {
    const auto row = image.data.begin() + static_cast<ptrdiff_t>(y) * image.width * kChannels;
    both.data.insert(both.data.end(), row, row + static_cast<ptrdiff_t>(image.width) * kChannels);
  };
  for (int y = 0; y < both.height; ++y) {
    append_row(left, y);
    both.data.insert(both.data.end(), kLine * kChannels, 255);
    append_row(right, y);
  }
  return both;
}

/// Writes the true image and the render of the middle test view. Nothing where the run has none.
bool WriteComparison(const fs::path& renders, const fs::path& file) {
  std::vector<fs::path> truths;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(renders, ignored)) {
    if (entry.path().stem().string().ends_with("_gt")) truths.push_back(entry.path());
  }
  if (truths.empty()) return false;
  std::sort(truths.begin(), truths.end());
  const fs::path truth = truths[truths.size() / 2];
  std::string name = truth.stem().string();
  name.resize(name.size() - 3);
  WritePng(file, SideBySide(ReadImage(truth), ReadImage(renders / (name + ".png"))));
  return true;
}

class DemoCommand : public Command {
 public:
  explicit DemoCommand(CLI::App* app)
      : Command(app, "demo", "Render a small scene and reconstruct it, in about two minutes: shows that all works",
                "oraclegs demo") {
    Bind("Output", &options_);
    Bind("Scene", &scene_, Level::kAdvanced);
    BindMachine(&run_.machine);
  }

 private:
  void Body(const Listener& listener) override {
    const fs::path scene = options_.out / "scene", run = options_.out / "run", image = options_.out / "demo.png";
    WriteDemoScene(scene, scene_, listener);
    run_.split.eval = true;
    run_.split.views = options_.views;
    run_.train.iterations = options_.iterations;
    run_.train.max_gaussians = 30000;
    RunRequest request;
    request.scene = scene, request.out = run, request.options = run_;
    request.estimates = true, request.overwrite = options_.overwrite, request.version = ORACLEGS_VERSION;
    const nlohmann::json before = request.overwrite ? nlohmann::json::object() : ReadStageRecords(run);
    const nlohmann::json metrics = Reconstruct(request, listener);
    Print(StageTable(Stages(), before, ReadStageRecords(run)) + SummaryOf(metrics, run));
    if (WriteComparison(WorkspacePaths(run).renders("test"), image)) {
      Print("Left: an image that the training did not see. Right: the same view of the splat.\n" + image.string());
    }
  }

  DemoOptions options_;
  DemoSceneOptions scene_;
  RunOptions run_;
};

}  // namespace

std::unique_ptr<Command> MakeDemo(CLI::App* app) { return std::make_unique<DemoCommand>(app); }

}  // namespace oraclegs
