#include "oraclegs/depth/nearest_sources.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "oraclegs/depth/plane.h"

namespace oraclegs {
namespace {

constexpr int kGrid = 16;                                           // sampled pixels along each side
constexpr double kAngle = 25 * std::numbers::pi_v<double> / 180.0;  // over which a direction's weight falls by e

}  // namespace

NearestSources::NearestSources(const std::vector<DepthMap>& maps) {
  for (const DepthMap& map : maps) {
    if (map.size() == 0) {
      AddNone();
    } else {
      Add(map.camera, [&map](size_t i) { return map.inv_depth[i]; });
    }
  }
}

void NearestSources::Add(const Camera& camera, FunctionRef<float(size_t)> inv_depth) {
  Source source{true, camera.Center(), {}};
  const Eigen::Isometry3d world_from_cam = camera.cam_from_world.inverse();
  for (int row = 0; row < kGrid; ++row) {
    for (int column = 0; column < kGrid; ++column) {
      const int x = (2 * column + 1) * camera.width / (2 * kGrid), y = (2 * row + 1) * camera.height / (2 * kGrid);
      const float w = inv_depth(static_cast<size_t>(y) * static_cast<size_t>(camera.width) + static_cast<size_t>(x));
      if (!(w > 0)) continue;
      const Eigen::Vector3f ray = RayOf(camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      source.points.push_back(world_from_cam * (ray / w).cast<double>().eval());
    }
  }
  sources_.push_back(std::move(source));
}

double NearestSources::Score(const Source& source, const Camera& to) {
  const Eigen::Vector3d center = to.Center();
  double score = 0;
  for (const Eigen::Vector3d& point : source.points) {
    const Eigen::Vector3d p = to.cam_from_world * point;
    if (!(p.z() > 0)) continue;
    const double u = to.fx * p.x() / p.z() + to.cx, v = to.fy * p.y() / p.z() + to.cy;
    if (!(u >= 0 && v >= 0 && u < to.width && v < to.height)) continue;
    const double cosine = (point - center).normalized().dot((point - source.center).normalized());
    score += std::exp(-std::acos(std::clamp(cosine, -1.0, 1.0)) / kAngle);
  }
  return score;
}

std::vector<size_t> NearestSources::For(const Camera& to, size_t most, std::optional<size_t> but) const {
  std::vector<std::pair<double, size_t>> scores;
  for (size_t s = 0; s < sources_.size(); ++s) {
    if (s != but && sources_[s].has_depth) scores.emplace_back(0, s);
  }
  if (scores.size() > most) {
    for (auto& [score, s] : scores) score = -Score(sources_[s], to);
    std::sort(scores.begin(), scores.end());
    scores.resize(most);
  }
  std::vector<size_t> best;
  for (const auto& [score, s] : scores) best.push_back(s);
  std::sort(best.begin(), best.end());
  return best;
}

}  // namespace oraclegs
