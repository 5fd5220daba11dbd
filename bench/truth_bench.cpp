// Accuracy of a run of a demo scene, whose true depth is known. Prints lines for stereo at the training views, and for
// the splat, where there is one, at the test views: each view, and all.
//   oraclegs demo-scene D && oraclegs reconstruct D -o OUT --eval --views 8 && build/release/bin/truth_bench OUT

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>

#include "bench/haze.h"
#include "oraclegs/core/files.h"
#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/depth/depth_files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/render/surface.h"
#include "oraclegs/run/start.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/stages/evaluate_stage.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr float kTrueUnit = 1e-3f;  // of demo-scene's depth images, scene units

/// Relative errors of depth. Pixels without any depth are not among them, and count as far off where they have to.
struct DepthErrors {
  size_t pixels = 0;  ///< with a true depth
  std::vector<float> errors;

  void Add(const DepthErrors& other) {
    pixels += other.pixels;
    errors.insert(errors.end(), other.errors.begin(), other.errors.end());
  }
  std::string Text() {
    std::sort(errors.begin(), errors.end());
    const size_t n = errors.size();
    const auto beyond = [&](float limit) {
      const auto first = std::upper_bound(errors.begin(), errors.end(), limit);
      return 100 * static_cast<double>(errors.end() - first) / static_cast<double>(std::max<size_t>(1, n));
    };
    return fmt::format("median error {:6.3f} %  over 2 % {:5.2f} %  over 10 % {:5.2f} %",
                       n > 0 ? 100 * errors[n / 2] : 0.f, beyond(0.02f), beyond(0.1f));
  }
};

std::vector<float> TrueDepth(const fs::path& scene, const SceneView& view) {
  const Image16 image = ReadPng16(scene / "depth" / fs::path(view.name).filename());
  std::vector<float> depth;
  for (const uint16_t value : image.values) depth.push_back(kTrueUnit * static_cast<float>(value));
  return depth;
}

float RelativeError(float inv_depth, float depth) {
  return inv_depth > 0 ? std::abs(1 / (inv_depth * depth) - 1) : std::numeric_limits<float>::infinity();
}

void PrintLine(const char* of, const std::string& name, const std::string& text) {
  std::printf("%s\n", fmt::format("{:<6} {:<16} {}", of, name, text).c_str());
}

// ---- Stereo: the errors of its confident pixels

void PrintStereo(const std::string& name, DepthErrors errors) {
  const double confident = 100.0 * static_cast<double>(errors.errors.size()) / static_cast<double>(errors.pixels);
  PrintLine("stereo", name, fmt::format("confident {:5.1f} %  {}", confident, errors.Text()));
}

DepthErrors StereoErrors(const DepthMap& map, const std::vector<float>& truth) {
  if (truth.size() != map.size()) throw InputError("the true depth has another size; give no --downscale");
  DepthErrors errors;
  for (size_t i = 0; i < map.size(); ++i) {
    if (truth[i] == 0) continue;
    ++errors.pixels;
    if (map.confidence[i] >= kConfident) errors.errors.push_back(RelativeError(map.inv_depth[i], truth[i]));
  }
  return errors;
}

void MeasureStereo(const Scene& scene, const std::vector<int>& views, const fs::path& folder) {
  DepthErrors all;
  for (const int v : views) {
    const SceneView& view = scene.views[static_cast<size_t>(v)];
    const auto maps = ReadDepthMaps(folder, {view.name}, {WorkingCamera(view, {})});
    const DepthErrors errors = StereoErrors(maps.front(), TrueDepth(scene.root, view));
    PrintStereo(view.name, errors);
    all.Add(errors);
  }
  PrintStereo("all", all);
}

// ---- The splat: the errors of the depth that `oraclegs render --what depth` shows, the inverse of the mean of 1/z by
// blending weights, and haze. Where a render shows no surface but there is one, its error is infinite.

void PrintSplat(const std::string& name, DepthErrors errors, const Haze& haze) {
  const auto pixels = static_cast<double>(std::max<size_t>(1, haze.pixels));
  PrintLine("splat", name,
            fmt::format("{}  haze before {:5.2f} %  behind {:5.2f} %", errors.Text(), 100 * haze.before / pixels,
                        100 * haze.behind / pixels));
}

DepthErrors SplatErrors(const RenderedSurface& surface, const std::vector<float>& truth) {
  DepthErrors errors;
  for (size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] > 0) errors.errors.push_back(RelativeError(surface.inv_depth[i], truth[i]));
  }
  errors.pixels = errors.errors.size();
  return errors;
}

void MeasureSplat(const Scene& scene, const std::vector<int>& views, const fs::path& ply) {
  const Model model = LoadModel(ply, {}, kCpu);  // in the scene's units
  const auto rasterizer = MakeRasterizer(kCpu);
  DepthErrors all;
  Haze all_haze;
  for (const int v : views) {
    const SceneView& view = scene.views[static_cast<size_t>(v)];
    const Camera camera = WorkingCamera(view, {});
    const std::vector<float> truth = TrueDepth(scene.root, view);
    const auto render = rasterizer->Forward(model.gaussians, camera, model.render, RenderPass::kInference);
    const DepthErrors errors = SplatErrors(SurfaceOf(render, camera), truth);
    const Haze haze = HazeOf(model.gaussians, camera, truth, model.render);
    PrintSplat(view.name, errors, haze);
    all.Add(errors);
    all_haze.pixels += haze.pixels, all_haze.before += haze.before, all_haze.behind += haze.behind;
  }
  PrintSplat("all", all, all_haze);
}

void Measure(const fs::path& workspace) {
  const WorkspacePaths paths(workspace);
  const Scene scene = ReadScene(ReadSavedRun(workspace).scene, {}, Silent());
  const nlohmann::json split = ReadRunJson(paths.split());
  const auto views_of = [&](const char* part) {
    std::vector<int> views;
    for (const std::string name : split.at(part)) {
      const auto has_name = [&](const SceneView& view) { return view.name == name; };
      const auto found = std::find_if(scene.views.begin(), scene.views.end(), has_name);
      if (found == scene.views.end()) throw InputError("{}: {} is not in the scene", paths.split().string(), name);
      views.push_back(static_cast<int>(found - scene.views.begin()));
    }
    return views;
  };
  std::error_code ignored;
  if (fs::exists(paths.depth(), ignored)) MeasureStereo(scene, views_of("train"), paths.depth());
  const std::vector<int> tests = views_of("test");
  if (fs::exists(paths.point_cloud(), ignored) && !tests.empty()) MeasureSplat(scene, tests, paths.point_cloud());
}

}  // namespace
}  // namespace oraclegs

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: truth_bench WORKSPACE_OF_A_DEMO_SCENE\n");
    return 2;
  }
  try {
    oraclegs::Measure(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "truth_bench: error: %s\n", error.what());
    return 3;
  }
}
