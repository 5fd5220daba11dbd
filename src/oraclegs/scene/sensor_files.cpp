#include "oraclegs/scene/sensor_files.h"

#include <algorithm>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/fit_cameras.h"

namespace oraclegs {
namespace {

constexpr const char* kWithoutSensor = "or leave the sensor out with --depth-prior stereo";

void RequirePhotoAspect(const std::filesystem::path& file, const SceneView& view) {
  int width = 0, height = 0;
  ReadImageSize(file, &width, &height);
  if (HaveSameAspect(width, height, view.intrinsics.width, view.intrinsics.height)) return;
  throw InputError(
      "{}: is {} x {}, which is not the aspect of its photo {} ({} x {}); crop or turn it as the photo, {}",
      file.string(), width, height, view.name, view.intrinsics.width, view.intrinsics.height, kWithoutSensor);
}

}  // namespace

size_t CountSensorDepth(const Scene& scene) {
  return static_cast<size_t>(std::count_if(scene.views.begin(), scene.views.end(),
                                           [](const SceneView& view) { return !view.depth_path.empty(); }));
}

SensorDepth SensorDepthOf(const Scene& scene) {
  const size_t count = CountSensorDepth(scene);
  if (count == 0) return SensorDepth::kNone;
  return 2 * count < scene.views.size() ? SensorDepth::kSome : SensorDepth::kMost;
}

void CheckSensorFiles(const Scene& scene) {
  for (const SceneView& view : scene.views) {
    if (view.depth_path.empty()) continue;
    if (PngGrayBits(ReadHead(view.depth_path, kPngHeaderBytes)) != 16) {
      throw InputError("{}: is no gray PNG of 16 bits; write the depth of {} so, {}", view.depth_path.string(),
                       view.name, kWithoutSensor);
    }
    RequirePhotoAspect(view.depth_path, view);
    if (!view.confidence_path.empty()) RequirePhotoAspect(view.confidence_path, view);
  }
}

}  // namespace oraclegs
