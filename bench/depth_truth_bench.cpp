// Accuracy of depth where truth is known. Prints a line per view and one for all.
//   oraclegs demo-scene /tmp/demo && oraclegs depth /tmp/demo -o /tmp/out && build/release/bin/depth_truth_bench
//   /tmp/out

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "oraclegs/depth/depth_files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/run/start.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/read_scene.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr float kTrueUnit = 1e-3f;  // of demo-scene's depth images, scene units

struct Errors {
  size_t pixels = 0;  ///< with a true depth
  std::vector<float> confident;

  void Add(const Errors& other) {
    pixels += other.pixels;
    confident.insert(confident.end(), other.confident.begin(), other.confident.end());
  }
};

Errors Compare(const DepthMap& map, const Image16& truth) {
  if (truth.values.size() != map.size()) throw InputError("the true depth has another size; give no --downscale");
  Errors errors;
  for (size_t i = 0; i < map.size(); ++i) {
    if (truth.values[i] == 0) continue;
    ++errors.pixels;
    if (map.confidence[i] < kConfident) continue;
    const float depth = kTrueUnit * static_cast<float>(truth.values[i]);
    errors.confident.push_back(std::abs(1 / (map.inv_depth[i] * depth) - 1));
  }
  return errors;
}

void Print(const std::string& name, Errors errors) {
  std::sort(errors.confident.begin(), errors.confident.end());
  const size_t n = errors.confident.size();
  const auto beyond = [&](float limit) {
    const auto first = std::upper_bound(errors.confident.begin(), errors.confident.end(), limit);
    return 100 * static_cast<double>(errors.confident.end() - first) / static_cast<double>(std::max<size_t>(1, n));
  };
  std::printf("%s\n",
              fmt::format("{:<16} confident {:5.1f} %  median error {:6.3f} %  over 2 % {:5.2f} %  over 10 % {:5.2f} %",
                          name, 100.0 * static_cast<double>(n) / static_cast<double>(errors.pixels),
                          n > 0 ? 100 * errors.confident[n / 2] : 0.f, beyond(0.02f), beyond(0.1f))
                  .c_str());
}

void CompareAll(const fs::path& workspace) {
  const SavedRun saved = ReadSavedRun(workspace);
  const Scene scene = ReadScene(saved.scene, {}, Silent());
  SplitOptions options;
  // The views of the training split, whatever the options were.
  const std::string file = fmt::format("@{}", (workspace / "split.json").string());
  options.train_views = file;
  const Split split = SplitViews(scene, WithListsRead(options));
  Errors all;
  for (const int v : split.train) {
    const SceneView& view = scene.views[static_cast<size_t>(v)];
    const auto maps = ReadDepthMaps(workspace / "depth", {view.name}, {WorkingCamera(view, {})});
    const fs::path truth = saved.scene / "depth" / fs::path(view.name).filename();
    const Errors errors = Compare(maps.front(), ReadPng16(truth));
    Print(view.name, errors);
    all.Add(errors);
  }
  Print("all", all);
}

}  // namespace

}  // namespace oraclegs

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: depth_truth_bench WORKSPACE_OF_A_DEMO_SCENE\n");
    return 2;
  }
  try {
    oraclegs::CompareAll(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "depth_truth_bench: error: %s\n", error.what());
    return 3;
  }
}
