#include "oraclegs/sfm/colmap_quality.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kFewestPointsPerImage = 6;    // a pose has six degrees of freedom, a point seen twice fixes one
constexpr double kSmallestParallax = .25;   // degrees; half a pixel of a phone's picture is about 0.02
constexpr double kClearlyMorePoints = 1.1;  // matching differs by a few percent from run to run
constexpr double kDegrees = 180 / 3.14159265358979323846;

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double AngleDegrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return kDegrees * std::atan2(a.cross(b).norm(), a.dot(b));  // exact for small angles too
}

bool IsPlausible(const Intrinsics& lens) {
  const double side = std::max(lens.width, lens.height);
  for (const double focal : {lens.fx(), lens.fy()}) {
    if (!(focal >= kFocalRange[0] * side && focal <= kFocalRange[1] * side)) return false;
  }
  const bool radial = lens.model == CameraModel::kSimpleRadial || lens.model == CameraModel::kRadial;
  return !radial || std::abs(lens.params[3]) <= kLargestDistortion;
}

}  // namespace

ModelQuality MeasureModel(const ColmapCameras& cameras, const std::vector<ColmapImage>& images,
                          const std::vector<ColmapPoint>& points) {
  ModelQuality model;
  std::unordered_map<uint32_t, size_t> index_of;
  std::vector<Eigen::Vector3d> centers;
  for (const ColmapImage& image : images) {
    index_of[image.id] = centers.size();
    centers.push_back(image.cam_from_world.inverse().translation());
    const auto lens = cameras.find(image.camera_id);
    if (lens == cameras.end() || !IsPlausible(lens->second)) model.plausible_lenses = false;
  }
  std::vector<std::vector<double>> angles(images.size());
  std::vector<double> widest_angles;
  for (const ColmapPoint& point : points) {
    std::vector<size_t> track;
    for (const uint32_t id : point.image_ids) {
      const auto found = index_of.find(id);
      if (found != index_of.end()) track.push_back(found->second);
    }
    std::sort(track.begin(), track.end());
    track.erase(std::unique(track.begin(), track.end()), track.end());
    if (track.size() < 2 || !point.xyz.allFinite()) continue;
    double widest_of_all = 0;
    for (const size_t i : track) {
      double widest = 0;
      for (const size_t j : track) {
        widest = std::max(widest, AngleDegrees(centers[i] - point.xyz, centers[j] - point.xyz));
      }
      angles[i].push_back(widest);
      widest_of_all = std::max(widest_of_all, widest);
    }
    widest_angles.push_back(widest_of_all);
    model.reprojection_error += std::max(0., point.reprojection_error);
    ++model.points;
  }
  if (model.points > 0) model.reprojection_error /= model.points;
  model.parallax_degrees = Median(std::move(widest_angles));
  for (size_t i = 0; i < images.size(); ++i) {
    const int seen = static_cast<int>(angles[i].size());
    model.images[images[i].name] = {seen, Median(std::move(angles[i]))};
  }
  return model;
}

ModelQuality MeasureModel(const fs::path& model_dir) {
  return MeasureModel(ReadColmapCameras(model_dir), ReadColmapImages(model_dir), ReadColmapPoints(model_dir));
}

bool IsSound(const ModelQuality& model) {
  return model.registered() >= 2 && model.plausible_lenses &&
         model.points >= kFewestPointsPerImage * model.registered() && model.parallax_degrees >= kSmallestParallax;
}

bool IsBetter(const ModelQuality& a, const ModelQuality& b) {
  if (IsSound(a) != IsSound(b)) return IsSound(a);
  if (a.registered() != b.registered()) return a.registered() > b.registered();
  if (a.points > kClearlyMorePoints * b.points) return true;
  if (b.points > kClearlyMorePoints * a.points) return false;
  return a.reprojection_error < b.reprojection_error;
}

}  // namespace oraclegs
