#include "oraclegs/output/info.h"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "oraclegs/capture/photo_checks.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/datasets/read_scene.h"
#include "oraclegs/formats/splat_file.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/sensor_files.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/train/checkpoint.h"
#include "oraclegs/train/checkpoint_folder.h"
#include "oraclegs/workspace/stage_records.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// "4000x3000", read from the file of a photo without a camera; empty when it cannot be read.
std::string SizeOfPhoto(const fs::path& photo) {
  try {
    int width = 0, height = 0;
    ReadImageSize(photo, &width, &height);
    return fmt::format("{}x{}", width, height);
  } catch (const Error&) {
    return "";
  }
}

nlohmann::json DescribeScene(const fs::path& path, bool look, const Listener& listener) {
  const Scene scene = ReadScene(path, SceneReadOptions{.allow_outside = true, .faces = "faces"}, listener);
  std::map<std::string, int> models, sizes;
  size_t masks = 0, unreadable = 0;
  for (const SceneView& view : scene.views) {
    masks += view.mask_path.empty() ? 0 : 1;
    if (!view.intrinsics.params.empty()) {
      ++models[std::string(CameraModelName(view.intrinsics.model))];
      ++sizes[fmt::format("{}x{}", view.intrinsics.width, view.intrinsics.height)];
    } else if (const std::string size = SizeOfPhoto(view.image_path); !size.empty()) {
      ++sizes[size];
    } else {
      ++unreadable;
    }
  }
  nlohmann::json info = {{"kind", "scene"},
                         {"format", SceneFormatName(scene.format)},
                         {"views", scene.views.size()},
                         {"camera_models", models},
                         {"sizes", sizes},
                         {"points", scene.points.size()},
                         {"masks", masks},
                         {"sensor_depth", CountSensorDepth(scene)},
                         {"missing_images", scene.missing_images},
                         {"unreadable_images", unreadable},
                         {"poses", scene.HasPoses()}};
  if (look) info["warnings"] = CheckPhotos(PhotosToCheck(scene), listener).warnings;
  return info;
}

nlohmann::json DescribeSplat(const fs::path& path, const Listener& listener) {
  const GaussianPly ply = ReadSplat(path, listener);
  nlohmann::json info = {{"kind", "gaussians"}, {"gaussians", ply.gaussians.size()}, {"sh_degree", ply.sh_degree}};
  if (!ply.comments.empty()) info["comments"] = ply.comments;
  if (ply.antialiased) info["antialiased"] = true;
  if (ply.gaussians.size() == 0) return info;
  const Gaussians& gaussians = ply.gaussians;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
  double opacity = 0;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3f> mean(gaussians.means.data() + 3 * i);
    low = low.cwiseMin(mean), high = high.cwiseMax(mean);
    opacity += static_cast<double>(Sigmoid(gaussians.opacity_logits[i]));
  }
  std::vector<float> scales(gaussians.log_scales.span().begin(), gaussians.log_scales.span().end());
  info["bounding_box"] = {{"min", {low.x(), low.y(), low.z()}}, {"max", {high.x(), high.y(), high.z()}}};
  info["mean_opacity"] = opacity / static_cast<double>(gaussians.size());
  info["median_scale"] = std::exp(static_cast<double>(Median(&scales)));
  return info;
}

nlohmann::json DescribeWorkspace(const fs::path& path) {
  const SavedRun saved = ReadSavedRun(path);
  const WorkspacePaths paths(path);
  nlohmann::json info = {{"kind", "workspace"}, {"scene", saved.scene.string()}, {"options", saved.options}};
  std::error_code ignored;
  info["point_cloud"] = fs::exists(paths.point_cloud(), ignored);
  if (const std::string of = UnfinishedSplat(path); !of.empty()) info["unfinished"] = of;
  if (const auto checkpoint = NewestCheckpoint(paths.checkpoints())) info["checkpoint"] = checkpoint->string();
  if (fs::exists(paths.metrics(), ignored)) info["metrics"] = ReadMetrics(path);
  return info;
}

}  // namespace

nlohmann::json Describe(const fs::path& path, bool look, const Listener& listener) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    throw InputError("{}: does not exist; name a scene folder, a workspace or a splat file", path.string());
  }
  if (!fs::is_directory(path, ignored) || IsSplatFolder(path)) return DescribeSplat(path, listener);
  return IsWorkspace(path) ? DescribeWorkspace(path) : DescribeScene(path, look, listener);
}

}  // namespace oraclegs
