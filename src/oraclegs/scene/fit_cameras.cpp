#include "oraclegs/scene/fit_cameras.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/plural.h"
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
