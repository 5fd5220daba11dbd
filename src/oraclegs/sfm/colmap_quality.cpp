#include "oraclegs/sfm/colmap_quality.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "oraclegs/core/statistics.h"
#include "oraclegs/scene/read_colmap.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kMinPointsPerImage = 6;       // a pose has six degrees of freedom, a point seen twice fixes one
constexpr double kMinParallax = .25;        // degrees; half a pixel of a phone's image is about 0.02
constexpr double kClearlyMorePoints = 1.1;  // matching differs by a few percent from run to run
// Views of right models of 4 to 16 photos have 0.10 to 0.83 of their depth confirmed, misplaced ones 0.02 to 0.03.
constexpr double kMisplacedConfirmed = .05, kUsualConfirmed = .2;
constexpr double kMaxAngle = 180;  // degrees
constexpr double kDegrees = 180 / 3.14159265358979323846;

double AngleDegrees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return kDegrees * std::atan2(a.cross(b).norm(), a.dot(b));  // exact for small angles too
}

bool IsPlausible(const Intrinsics& intrinsics) {
  const double side = std::max(intrinsics.width, intrinsics.height);
  for (const double focal : {intrinsics.fx(), intrinsics.fy()}) {
    if (!(focal >= kFocalRange[0] * side && focal <= kFocalRange[1] * side)) return false;
  }
  const bool radial = intrinsics.model == CameraModel::kSimpleRadial || intrinsics.model == CameraModel::kRadial;
  return !radial || std::abs(intrinsics.params[3]) <= kMaxDistortion;
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
    const auto intrinsics = cameras.find(image.camera_id);
    if (intrinsics != cameras.end() && IsPlausible(intrinsics->second)) continue;
    model.plausible_intrinsics = false;
    model.implausible_images.push_back(image.name);
  }
  std::vector<std::vector<double>> angles(images.size()), nearest_angles(images.size());
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
      double widest = 0, nearest = kMaxAngle;
      for (const size_t j : track) {
        if (j == i) continue;
        const double angle = AngleDegrees(centers[i] - point.xyz, centers[j] - point.xyz);
        widest = std::max(widest, angle);
        nearest = std::min(nearest, angle);
      }
      angles[i].push_back(widest);
      nearest_angles[i].push_back(nearest);
      widest_of_all = std::max(widest_of_all, widest);
    }
    widest_angles.push_back(widest_of_all);
    model.reprojection_error += std::max(0., point.reprojection_error);
    ++model.points;
  }
  if (model.points > 0) model.reprojection_error /= model.points;
  model.parallax_degrees = UpperMedian(std::move(widest_angles));
  for (size_t i = 0; i < images.size(); ++i) {
    const int seen = static_cast<int>(angles[i].size());
    model.images[images[i].name] = {seen, UpperMedian(std::move(angles[i])), UpperMedian(std::move(nearest_angles[i]))};
  }
  return model;
}

ModelQuality MeasureModel(const fs::path& model_dir) {
  return MeasureModel(ReadColmapCameras(model_dir), ReadColmapImages(model_dir), ReadColmapPoints(model_dir));
}

bool IsSound(const ModelQuality& model) { return model.registered() >= 2 && FlawOf(model).empty(); }

std::string FlawOf(const ModelQuality& model) {
  if (model.registered() == 0) return "";
  const bool is_near = std::any_of(model.images.begin(), model.images.end(),
                                   [](const auto& entry) { return entry.second.nearest_degrees < kMaxDegreesOfSift; });
  if (!model.plausible_intrinsics) return "it needs a lens that there is not";
  if (model.points < kMinPointsPerImage * model.registered()) return "too few points hold its photos";
  if (!is_near) return "its photos share what they see only from far apart";
  if (model.parallax_degrees < kMinParallax) return "its photos are of one place";
  return "";
}

bool HasPlausiblePart(const ModelQuality& model) {
  const auto implausible = static_cast<int>(model.implausible_images.size());
  const int plausible = model.registered() - implausible;
  return implausible > 0 && plausible >= 2 && plausible > implausible;
}

bool HasLooseView(const ModelQuality& model) {
  std::vector<int> points;
  for (const auto& [name, image] : model.images) points.push_back(image.points);
  const int usual = UpperMedian(std::move(points));
  return std::any_of(model.images.begin(), model.images.end(), [&](const auto& entry) {
    return 3 * entry.second.points < usual || entry.second.nearest_degrees >= kMaxDegreesOfSift;
  });
}

std::vector<size_t> MisplacedViews(const std::vector<double>& confirmed_shares) {
  if (UpperMedian(confirmed_shares) < kUsualConfirmed) return {};
  std::vector<size_t> misplaced;
  for (size_t view = 0; view < confirmed_shares.size(); ++view) {
    if (confirmed_shares[view] < kMisplacedConfirmed) misplaced.push_back(view);
  }
  return misplaced;
}

bool IsBetter(const ModelQuality& a, const ModelQuality& b) {
  if (IsSound(a) != IsSound(b)) return IsSound(a);
  if (a.registered() != b.registered()) return a.registered() > b.registered();
  if (a.points > kClearlyMorePoints * b.points) return true;
  if (b.points > kClearlyMorePoints * a.points) return false;
  return a.reprojection_error < b.reprojection_error;
}

}  // namespace oraclegs
