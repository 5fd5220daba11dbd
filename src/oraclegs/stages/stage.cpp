#include "oraclegs/stages/stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "oraclegs/core/error.h"
#include "oraclegs/depth/gains.h"

namespace oraclegs {

std::string ViewsKey(Run* run, const std::vector<int>& views, const ImageOptions& images) {
  return ViewsFingerprint(run->Given(), views, images, &run->files);
}

const TrainingViews& ViewsOf(Run* run) {
  std::unique_ptr<TrainingViews>& views = run->results->views;
  if (!views) {
    views = std::make_unique<TrainingViews>(LoadViews(run->scene, run->split.train, run->plan.image, run->listener));
  }
  return *views;
}

std::optional<std::vector<LoadedView>> LargerViews(const Run& run, int shorter_side) {
  constexpr double kTimesRead = 2;
  const auto shorter_sides = [&](const ImageOptions& options, double* aspect) {
    int shortest = std::numeric_limits<int>::max();
    for (const Camera& camera : WorkingCameras(run.scene, run.split.train, options)) {
      const auto [shorter, longer] = std::minmax(camera.width, camera.height);
      shortest = std::min(shortest, shorter);
      *aspect = std::max(*aspect, static_cast<double>(longer) / shorter);
    }
    return shortest;
  };
  double aspect = 1;
  const int working = shorter_sides(run.plan.image, &aspect);
  if (working >= shorter_side) return std::nullopt;
  ImageOptions larger = run.plan.image;
  larger.downscale = 1;
  larger.max_size = static_cast<int>(std::ceil(kTimesRead * shorter_side * aspect));
  if (shorter_sides(larger, &aspect) <= working) return std::nullopt;
  return LoadViews(run.scene, run.split.train, larger, run.listener);
}

const Stage& StageNamed(const std::vector<Stage>& stages, const std::string& name) {
  for (const Stage& stage : stages) {
    if (stage.name == name) return stage;
  }
  throw RunError("there is no stage {}", name);
}

bool Geometry::HasVariedExposure() const { return ExposureSpread(gains) > 0; }

FusionOptions FusionOf(const std::vector<Eigen::Vector3f>& gains) {
  FusionOptions options;
  if (ExposureSpread(gains) > 0) options.gains = gains;
  return options;
}

}  // namespace oraclegs
