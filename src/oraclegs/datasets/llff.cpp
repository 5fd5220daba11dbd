#include "oraclegs/datasets/llff.h"

#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/datasets/dataset_images.h"
#include "oraclegs/datasets/npy.h"
#include "oraclegs/scene/rotation.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr char kPosesFile[] = "poses_bounds.npy";
constexpr int64_t kRowLength = 17;
using LlffPose = Eigen::Matrix<double, 3, 5, Eigen::RowMajor>;

int LlffSide(double side, const std::string& place) {
  if (side >= 1 && side <= kMaxImageSide && side == std::round(side)) return static_cast<int>(side);
  throw InputError(
      "{}: has an image side of {} pixels; expected a 3x5 matrix whose last column is height, width, focal", place,
      side);
}

void FillLlffCamera(const LlffPose& pose, const std::string& place, SceneView* view) {
  Intrinsics& intrinsics = view->intrinsics;
  intrinsics.height = LlffSide(pose(0, 4), place);
  intrinsics.width = LlffSide(pose(1, 4), place);
  const double focal = pose(2, 4);
  intrinsics.model = CameraModel::kPinhole;
  intrinsics.params = {focal, focal, intrinsics.width / 2.0, intrinsics.height / 2.0};
  intrinsics.Check(place);
  Eigen::Matrix3d world_from_cam;
  world_from_cam << pose.col(1), pose.col(0), -pose.col(2);
  const Eigen::Matrix3d rotation = NearestRotation(world_from_cam, place).rotation.transpose();
  view->cam_from_world = Eigen::Isometry3d::Identity();
  view->cam_from_world->linear() = rotation;
  view->cam_from_world->translation() = -(rotation * pose.col(3));
  view->as_stored = true;  // the poses are colmap's, which ignores the EXIF orientation
}

}  // namespace

bool IsLlffScene(const fs::path& root) { return IsFile(root / kPosesFile); }

Scene ReadLlffScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const fs::path path = root / kPosesFile;
  const NpyArray rows = ParseNpy(ReadFile(path), path.string());
  if (rows.shape.size() != 2 || rows.shape[1] != kRowLength || rows.shape[0] == 0) {
    throw InputError("{}: is {}, expected 17 numbers for each image, as LLFF writes them", path.string(),
                     rows.ShapeWords());
  }
  const fs::path folder = DatasetImageFolder(root, options);
  std::vector<SceneView> views = ViewsOfRows(folder, static_cast<size_t>(rows.shape[0]), path.string(), "row");
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Map<const LlffPose> pose(rows.values.data() + i * kRowLength);
    const std::string place = fmt::format("{}: row {} ({})", path.string(), i, views[i].name);
    if (!pose.allFinite()) throw InputError("{}: has numbers that are not finite", place);
    FillLlffCamera(pose, place, &views[i]);
  }
  return SceneOfDataset(path, SceneFormat::kLlff, std::move(views), folder, listener);
}

}  // namespace oraclegs
