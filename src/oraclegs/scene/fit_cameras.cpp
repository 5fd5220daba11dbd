#include "oraclegs/scene/fit_cameras.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

struct ImageSize {
  int width = 0, height = 0;
};

/// The size that the view's intrinsics must be scaled to; nothing when they fit, or cannot.
std::optional<ImageSize> SizeToFit(const SceneView& view) {
  std::vector<Orientation> ways{Orientation::kUpright, Orientation::kAsStored};
  if (view.as_stored) std::swap(ways[0], ways[1]);
  std::optional<ImageSize> fitting;
  for (const Orientation way : ways) {
    ImageSize size;
    try {
      ReadImageSize(view.image_path, &size.width, &size.height, way);
    } catch (const Error&) {
      return std::nullopt;
    }
    const Intrinsics& camera = view.intrinsics;
    if (size.width == camera.width && size.height == camera.height) return std::nullopt;
    if (!fitting && HaveSameAspect(size.width, size.height, camera.width, camera.height)) fitting = size;
  }
  return fitting;
}

/// How many times larger than its image the camera looks by its principal point, which is near the middle of what it
/// was made for; 1 when it does not.
double SizeByCenter(const Intrinsics& camera) {
  constexpr double kAgreement = .05, kMinRatio = 1.4;
  if (camera.params.empty()) return 1;
  const double x = 2 * camera.cx() / camera.width, y = 2 * camera.cy() / camera.height;
  const bool agree = std::abs(x - y) <= kAgreement * std::max(x, y);
  return agree && x > 0 && std::max(x, 1 / x) >= kMinRatio ? (x + y) / 2 : 1;
}

void WarnOfCenters(const Scene& scene, const Listener& listener) {
  const auto odd = [](const SceneView& view) { return SizeByCenter(view.intrinsics) != 1; };
  const auto found = std::find_if(scene.views.begin(), scene.views.end(), odd);
  if (found == scene.views.end()) return;
  const Intrinsics& camera = found->intrinsics;
  listener(
      Warning{fmt::format("{}: {} of {} have their principal point far from the middle, e.g. {} at ({:.6g}, {:.6g}) of "
                          "{} x {} pixels, as if "
                          "made for images {:.3g} times as large; if so, say for which size (\"w\", \"h\")",
                          scene.root.string(), std::count_if(scene.views.begin(), scene.views.end(), odd),
                          Counted(scene.views.size(), "camera"), found->name, camera.cx(), camera.cy(), camera.width,
                          camera.height, SizeByCenter(camera))});
}

}  // namespace

bool HaveSameAspect(int width, int height, int other_width, int other_height) {
  if (width == other_width || height == other_height) return width == other_width && height == other_height;
  const double x = static_cast<double>(width) / other_width, y = static_cast<double>(height) / other_height;
  return std::abs(width - y * other_width) < 1 || std::abs(height - x * other_height) < 1;
}

void FitCamerasToImages(Scene* scene, const Listener& listener) {
  std::vector<std::optional<ImageSize>> sizes(scene->views.size());
  ParallelFor(static_cast<int64_t>(sizes.size()), [&](int64_t i) {
    const SceneView& view = scene->views[static_cast<size_t>(i)];
    if (!view.intrinsics.params.empty()) sizes[static_cast<size_t>(i)] = SizeToFit(view);
  });
  WarnOfCenters(*scene, listener);
  std::string example;
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (!sizes[i]) continue;
    SceneView& view = scene->views[i];
    const auto [width, height] = *sizes[i];
    if (example.empty()) {
      example = fmt::format("{} is {} x {} and its camera {} x {}", view.name, width, height, view.intrinsics.width,
                            view.intrinsics.height);
    }
    view.intrinsics = Resized(view.intrinsics, width, height);
  }
  if (example.empty()) return;
  const auto count = std::count_if(sizes.begin(), sizes.end(), [](const auto& size) { return size.has_value(); });
  listener(Note{fmt::format("{}: {} of {} have another size than their cameras ({}); the cameras are scaled to them",
                            scene->root.string(), count, Counted(sizes.size(), "photo"), example)});
}

}  // namespace oraclegs
