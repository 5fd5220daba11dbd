#include "oraclegs/datasets/neus.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <map>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/datasets/dataset_images.h"
#include "oraclegs/datasets/npy.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using Members = std::map<std::string, std::string>;

constexpr const char* kNeusFiles[] = {"cameras_sphere.npz", "cameras.npz"};
constexpr int64_t kMaxMembers = 100000;
constexpr double kMaxSkewPixels = 1;  // at the image's edge

fs::path NeusFile(const fs::path& root) {
  for (const char* name : kNeusFiles) {
    if (IsFile(root / name)) return root / name;
  }
  return {};
}

/// Matrix NAME_i of the archive; a missing one is the identity where that is allowed.
Eigen::Matrix4d NeusMatrix(const Members& members, const std::string& name, const std::string& file, bool required) {
  const auto found = members.find(name + ".npy");
  if (found == members.end()) {
    if (!required) return Eigen::Matrix4d::Identity();
    throw InputError("{}: has no {}; it needs world_mat_0, world_mat_1, ... for the images in the order of their names",
                     file, name);
  }
  const std::string place = fmt::format("{}: {}", file, name);
  const NpyArray array = ParseNpy(found->second, place);
  if (array.shape != std::vector<int64_t>{4, 4} && array.shape != std::vector<int64_t>{3, 4}) {
    throw InputError("{}: is {}, expected 4 x 4", place, array.ShapeWords());
  }
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (size_t i = 0; i < array.values.size(); ++i)
    matrix(static_cast<int>(i) / 4, static_cast<int>(i) % 4) = array.values[i];
  return matrix;
}

size_t CountOfMatrices(const Members& members) {
  size_t count = 0;
  while (members.count(fmt::format("world_mat_{}.npy", count)) > 0) ++count;
  return count;
}

/// Skew that is left out, as the largest movement of a pixel.
void ReportSkew(const std::string& file, double pixels, const Listener& listener) {
  if (pixels <= kMaxSkewPixels) return;
  listener(
      Warning{fmt::format("{}: the axes of its images are not at right angles; leaving that out moves pixels by up "
                          "to {:.2g}; use undistorted photos",
                          file, pixels)});
}

void AttachMasksInOrder(const fs::path& root, std::vector<SceneView>* views) {
  for (const char* name : {"mask", "masks"}) {
    if (!IsFolder(root / name)) continue;
    const std::vector<fs::path> masks = SortedImages(root / name);
    if (masks.size() != views->size()) continue;
    for (size_t i = 0; i < masks.size(); ++i) (*views)[i].mask_path = masks[i];
    return;
  }
}

}  // namespace

bool IsNeusScene(const fs::path& root) { return !NeusFile(root).empty(); }

ProjectionParts TakeApart(const Eigen::Matrix<double, 3, 4>& projection, const std::string& place) {
  Eigen::Matrix3d m = projection.leftCols<3>();
  Eigen::Vector3d t = projection.col(3);
  const double size = m.norm();
  if (!projection.allFinite() || !(std::abs((m / size).determinant()) > 1e-12)) {
    throw InputError("{}: is the projection of no camera: its left 3 x 3 numbers are singular or not finite", place);
  }
  if (m.determinant() < 0) {  // a projection may have any factor
    m = -m;
    t = -t;
  }
  // RQ by QR: rows in reverse order, transposed.
  const Eigen::Matrix3d reverse = Eigen::Matrix3d::Identity().rowwise().reverse();
  const Eigen::HouseholderQR<Eigen::Matrix3d> qr((reverse * m).transpose());
  const Eigen::Matrix3d upper = qr.matrixQR().triangularView<Eigen::Upper>(), q = qr.householderQ();
  Eigen::Matrix3d k = reverse * upper.transpose() * reverse, r = reverse * q.transpose();
  const Eigen::Vector3d signs = k.diagonal().unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; });
  k = k * signs.asDiagonal();
  r = signs.asDiagonal() * r;
  ProjectionParts parts;
  parts.camera.cam_from_world = Eigen::Isometry3d::Identity();
  parts.camera.cam_from_world.linear() = r;
  parts.camera.cam_from_world.translation() = k.inverse() * t;
  k /= k(2, 2);
  parts.camera.fx = k(0, 0);
  parts.camera.fy = k(1, 1);
  parts.camera.cx = k(0, 2);
  parts.camera.cy = k(1, 2);
  parts.skew = k(0, 1);
  return parts;
}

Scene ReadNeusScene(const fs::path& root, const SceneReadOptions& options, const Listener& listener) {
  const fs::path path = NeusFile(root);
  const std::string file = path.string();
  const Members members = ReadZip(ReadFile(path), kMaxMembers, file);
  const fs::path folder = DatasetImageFolder(root, options, {"image", "images", "rgb"});
  std::vector<SceneView> views = ViewsOfRows(folder, std::max<size_t>(CountOfMatrices(members), 1), file, "camera");
  double skew = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    SceneView& view = views[i];
    const Eigen::Matrix4d world = NeusMatrix(members, fmt::format("world_mat_{}", i), file, true);
    const Eigen::Matrix4d scale = NeusMatrix(members, fmt::format("scale_mat_{}", i), file, false);
    const std::string place = fmt::format("{}: world_mat_{} ({})", file, i, view.name);
    const auto [camera, view_skew] = TakeApart((world * scale).topRows<3>(), place);
    Intrinsics& intrinsics = view.intrinsics;
    ReadImageSize(view.image_path, &intrinsics.width, &intrinsics.height);
    intrinsics.params = {camera.fx, camera.fy, camera.cx, camera.cy};
    intrinsics.Check(place);
    view.cam_from_world = camera.cam_from_world;
    skew = std::max(skew, std::abs(view_skew) * intrinsics.height / 2 / camera.fy);
  }
  ReportSkew(file, skew, listener);
  AttachMasksInOrder(root, &views);
  return SceneOfDataset(path, SceneFormat::kNeus, std::move(views), folder, listener);
}

}  // namespace oraclegs
