#include "oraclegs/networks/seva/orbit.h"

#include <Eigen/QR>
#include <cmath>

#include "oraclegs/camera/camera_path.h"

namespace oraclegs::seva {

Eigen::Vector3d LookAtPoint(const std::vector<View>& views) {
  if (views.empty()) throw ShapeError("LookAtPoint: there are no cameras");
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const View& view : views) mean += view.center() / static_cast<double>(views.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const View& view : views) {
    const Eigen::Vector3d axis = view.world_from_camera.linear().col(2).normalized();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    sum += across;
    right += across * (view.center() - mean);
  }
  return mean + sum.completeOrthogonalDecomposition().solve(right);
}

Eigen::Vector3d UpOf(const std::vector<View>& views) {
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  for (const View& view : views) down += view.world_from_camera.linear().col(1);
  return -down.normalized();
}

std::vector<Eigen::Isometry3d> Orbit(const Eigen::Vector3d& start, const Eigen::Vector3d& center,
                                     const Eigen::Vector3d& up, int64_t count) {
  std::vector<Eigen::Isometry3d> poses;
  for (int64_t i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(count);
    const Eigen::Vector3d position = center + Eigen::AngleAxisd(angle, up) * (start - center);
    poses.push_back(LookAt(position, center, up).inverse());
  }
  return poses;
}

std::vector<View> OrbitAnchors(const std::vector<View>& inputs, const std::vector<View>& targets, int64_t count) {
  if (inputs.empty()) throw ShapeError("OrbitAnchors: there are no input views");
  std::vector<View> all = inputs;
  all.insert(all.end(), targets.begin(), targets.end());
  const std::vector<Eigen::Isometry3d> poses =
      Orbit(inputs.front().center(), LookAtPoint(all), UpOf(inputs), count + 1);
  const View& like = targets.empty() ? inputs.front() : targets.front();
  std::vector<View> anchors;
  for (size_t i = 1; i < poses.size(); ++i) anchors.push_back({poses[i], like.intrinsics});
  return anchors;
}

}  // namespace oraclegs::seva
