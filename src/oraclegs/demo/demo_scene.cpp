#include "oraclegs/demo/demo_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/demo/depth_sensor.h"
#include "oraclegs/image/codecs.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kStage[] = "demo-scene";
constexpr char kMarker[] = "demo_scene.json";  // written first: marks the folder as a demo scene's

/// Camera-to-world matrix with OpenGL axes (x right, y up, z backward), as in transforms.json.
nlohmann::json TransformMatrix(const RayCamera& c) {
  return {{c.right.x, -c.down.x, -c.forward.x, c.center.x},
          {c.right.y, -c.down.y, -c.forward.y, c.center.y},
          {c.right.z, -c.down.z, -c.forward.z, c.center.z},
          {0.0, 0.0, 0.0, 1.0}};
}

std::string NumberedPng(int i) { return fmt::format("{:03}.png", i); }

bool IsFormerDemoScene(const fs::path& dir) {
  try {
    return nlohmann::json::parse(ReadFile(dir / kMarker, 1 << 20)).at("generator") == "oraclegs demo-scene";
  } catch (const std::exception&) {
    return false;  // missing or not ours
  }
}

/// Claims an empty folder or a former demo scene. Images and depth maps of a former one are removed, since it may have
/// had more views; anything else in the folder stays.
void ClaimFolder(const fs::path& dir, const DemoSceneOptions& options) {
  std::error_code error;
  const bool exists = fs::exists(dir, error);
  if (exists && !fs::is_directory(dir, error)) throw RunError("{}: is not a folder; name another", dir.string());
  if (exists && !fs::is_empty(dir, error) && !IsFormerDemoScene(dir)) {
    throw RunError("{}: already holds something that is not a demo scene; name a new or empty folder", dir.string());
  }
  RequireWritableFolder(dir);
  fs::remove(dir / "transforms.json", error);
  for (const char* sub : {"images", "depth", "sensor", "sensor_confidence"}) {
    for (int i = 0; fs::remove(dir / sub / NumberedPng(i), error); ++i) continue;
  }
  nlohmann::json marker = OptionsToJson(options);
  marker["generator"] = "oraclegs demo-scene";
  WriteFileAtomically(dir / kMarker, marker.dump(2) + "\n");
}

/// Writes what a sensor measures of a view, and names the files in its frame.
void AddSensor(const fs::path& dir, const RayTracedView& view, int i, nlohmann::json* frame) {
  const std::string depth = "sensor/" + NumberedPng(i), confidence = "sensor_confidence/" + NumberedPng(i);
  const SensedDepth sensed = SenseDepth(view.depth, view.rgb.width, view.rgb.height, i);
  WritePng16(dir / depth, sensed.width, sensed.height, sensed.depth);
  WritePng(dir / confidence, sensed.confidence);
  (*frame)["depth_file_path"] = depth;
  (*frame)["confidence_file_path"] = confidence;
}

}  // namespace

void WriteDemoScene(const fs::path& dir, const DemoSceneOptions& options, const Listener& listener) {
  CheckOptions(options);
  if (options.sensor && options.kind == DemoKind::kSpheres) {
    throw UsageError("--sensor: a depth sensor looks one way; take another --kind than spheres");
  }
  ClaimFolder(dir, options);
  listener(StageStarted{kStage});
  const auto start = std::chrono::steady_clock::now();
  const RayScene world = DemoWorld(options.kind);
  const bool all_around = options.kind == DemoKind::kSpheres;
  const int height = all_around ? options.width / 2 : options.height;
  const double focal = all_around ? height : .92 * options.width;  // as Nerfstudio writes it
  nlohmann::json scene = {{"camera_model", all_around ? "EQUIRECTANGULAR" : "PINHOLE"},
                          {"w", options.width},
                          {"h", height},
                          {"fl_x", focal},
                          {"fl_y", focal},
                          {"cx", .5 * options.width},
                          {"cy", .5 * height}};
  for (int i = 0; i < options.views; ++i) {
    ThrowIfInterrupted();
    const RayCamera camera = DemoCamera(options.kind, i, options.views, options.width, height);
    const RayTracedView view = TraceView(world, camera, options.samples, i);
    const std::string image = "images/" + NumberedPng(i), depth = "depth/" + NumberedPng(i);
    WritePng(dir / image, view.rgb);
    WritePng16(dir / depth, options.width, height, view.depth);
    nlohmann::json frame = {{"file_path", image}, {"transform_matrix", TransformMatrix(camera)}};
    if (options.sensor) AddSensor(dir, view, i, &frame);
    scene["frames"].push_back(std::move(frame));
    listener(StepDone{kStage, i + 1, options.views, "views", ""});
  }
  // Written last, so that a folder with this file is a complete scene.
  WriteFileAtomically(dir / "transforms.json", scene.dump(1) + "\n");
  listener(FileWritten{dir / "transforms.json"});
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  listener(StageFinished{kStage, seconds.count()});
}

}  // namespace oraclegs
