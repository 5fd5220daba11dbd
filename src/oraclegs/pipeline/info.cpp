#include "oraclegs/pipeline/info.h"

#include <algorithm>
#include <map>
#include <vector>

#include "oraclegs/gaussians/ply.h"
#include "oraclegs/pipeline/workspace/metrics.h"
#include "oraclegs/pipeline/workspace/workspace.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/train/checkpoint.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

const char* FormatName(SceneFormat format) {
  switch (format) {
    case SceneFormat::kColmap:
      return "COLMAP model";
    case SceneFormat::kTransforms:
      return "transforms.json";
    case SceneFormat::kBlender:
      return "Blender (NeRF synthetic)";
    case SceneFormat::kPhotos:
      return "photographs without poses";
  }
  return "";
}

nlohmann::json DescribeScene(const fs::path& path, const Listener& listener) {
  const Scene scene = ReadScene(path, SceneReadOptions{}, listener);
  std::map<std::string, int> lenses, sizes;
  size_t masks = 0;
  for (const SceneView& view : scene.views) {
    masks += view.mask_path.empty() ? 0 : 1;
    if (view.lens.params.empty()) continue;
    ++lenses[std::string(CameraModelName(view.lens.model))];
    ++sizes[fmt::format("{}x{}", view.lens.width, view.lens.height)];
  }
  return {{"kind", "scene"},
          {"format", FormatName(scene.format)},
          {"views", scene.views.size()},
          {"lenses", lenses},
          {"sizes", sizes},
          {"points", scene.points.size()},
          {"masks", masks},
          {"missing_images", scene.missing_images},
          {"poses", scene.HasPoses()}};
}

nlohmann::json DescribePly(const fs::path& path) {
  const GaussianPly ply = ReadGaussianPly(path);
  nlohmann::json info = {{"kind", "gaussians"}, {"gaussians", ply.gaussians.size()}, {"sh_degree", ply.sh_degree}};
  if (!ply.comments.empty()) info["comments"] = ply.comments;
  if (ply.gaussians.size() == 0) return info;
  std::vector<double> low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const Buffer<float> column = ply.gaussians.means.select(1, axis);
    low.push_back(column.min().item<double>());
    high.push_back(column.max().item<double>());
  }
  const Buffer<float> opacity = torch::sigmoid(ply.gaussians.opacity_logits);
  info["bounding_box"] = {{"min", low}, {"max", high}};
  info["mean_opacity"] = opacity.mean().item<double>();
  info["median_scale"] = ply.gaussians.log_scales.flatten().median().exp().item<double>();
  return info;
}

nlohmann::json DescribeWorkspace(const fs::path& path) {
  const SavedRun saved = ReadSavedRun(path);
  const WorkspacePaths paths(path);
  nlohmann::json info = {{"kind", "workspace"}, {"scene", saved.scene.string()}, {"options", saved.options}};
  std::error_code ignored;
  info["point_cloud"] = fs::exists(paths.point_cloud(), ignored);
  if (const auto checkpoint = NewestCheckpoint(paths.checkpoints())) info["checkpoint"] = checkpoint->string();
  if (fs::exists(paths.metrics(), ignored)) info["metrics"] = ReadMetrics(path);
  return info;
}

}  // namespace

nlohmann::json Describe(const fs::path& path, const Listener& listener) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    throw InputError("{}: does not exist; name a scene folder, a workspace or a .ply file", path.string());
  }
  if (!fs::is_directory(path, ignored)) return DescribePly(path);
  return IsWorkspace(path) ? DescribeWorkspace(path) : DescribeScene(path, listener);
}

}  // namespace oraclegs
