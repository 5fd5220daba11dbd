#include "oraclegs/depth/align.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr double kMinShareOfMedian = 0.2, kMaxShareOfMedian = 5;  // of a reliable scale
constexpr double kSpanOfMedian = 1e-3;

double MeanDeviation(const std::vector<double>& values, double from) {
  double sum = 0;
  for (const double value : values) sum += std::abs(value - from);
  return sum / static_cast<double>(values.size());
}

}  // namespace

double SampleAt(const RelativeDepth& map, double u, double v) {
  const double x = std::clamp(u, 0.0, static_cast<double>(map.width - 1));
  const double y = std::clamp(v, 0.0, static_cast<double>(map.height - 1));
  const int x0 = std::min(static_cast<int>(x), std::max(0, map.width - 2));
  const int y0 = std::min(static_cast<int>(y), std::max(0, map.height - 2));
  const int x1 = std::min(x0 + 1, map.width - 1), y1 = std::min(y0 + 1, map.height - 1);
  const double s = x - x0, t = y - y0;
  const auto at = [&](int column, int row) {
    return static_cast<double>(map.values[static_cast<size_t>(row) * static_cast<size_t>(map.width) + column]);
  };
  return (1 - t) * ((1 - s) * at(x0, y0) + s * at(x1, y0)) + t * ((1 - s) * at(x0, y1) + s * at(x1, y1));
}

std::vector<KnownDepth> KnownDepths(const std::vector<ScenePoint>& points, int view, const Camera& camera) {
  std::vector<KnownDepth> known;
  for (const ScenePoint& point : points) {
    if (!std::binary_search(point.views.begin(), point.views.end(), view)) continue;
    const Eigen::Vector3d p = camera.cam_from_world * point.xyz;
    if (p.z() == 0) continue;
    known.push_back({camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy, 1 / p.z()});
  }
  return known;
}

Alignment Align(const RelativeDepth& map, const Camera& camera, const std::vector<KnownDepth>& known,
                const AlignmentRule& rule) {
  Alignment out;
  std::vector<double> inverse, relative;
  double least = HUGE_VAL, most = -HUGE_VAL;
  const double ratio = static_cast<double>(map.height) / camera.height;
  for (const KnownDepth& k : known) {
    least = std::min(least, k.inv_depth), most = std::max(most, k.inv_depth);
    const double u = ratio * k.x, v = ratio * k.y;
    const bool inside = u >= 0 && v >= 0 && u < ratio * camera.width && v < ratio * camera.height;
    if (!inside || !(k.inv_depth > 0)) continue;
    inverse.push_back(k.inv_depth);
    relative.push_back(SampleAt(map, u - rule.center, v - rule.center));
  }
  out.points = static_cast<int>(inverse.size());
  if (inverse.empty()) return out;
  out.known_median = Median(inverse), out.known_deviation = MeanDeviation(inverse, out.known_median);
  out.relative_median = Median(relative), out.relative_deviation = MeanDeviation(relative, out.relative_median);
  const bool is_fixed = out.points >= rule.min_points && most - least > rule.min_span && out.relative_deviation > 0;
  if (!is_fixed) return out;
  out.scale = out.known_deviation / out.relative_deviation;
  out.offset = out.known_median - out.scale * out.relative_median;
  return out;
}

std::vector<bool> AreReliable(const std::vector<Alignment>& alignments) {
  std::vector<double> positive;
  for (const Alignment& a : alignments) {
    if (a.scale > 0) positive.push_back(a.scale);
  }
  const double median = Median(&positive);
  std::vector<bool> reliable;
  for (const Alignment& a : alignments) {
    reliable.push_back(a.scale > 0 && a.scale >= kMinShareOfMedian * median && a.scale <= kMaxShareOfMedian * median);
  }
  return reliable;
}

double MinSpan(const std::vector<std::vector<KnownDepth>>& known) {
  std::vector<double> all;
  for (const auto& of_view : known) {
    for (const KnownDepth& k : of_view) {
      if (k.inv_depth > 0) all.push_back(k.inv_depth);
    }
  }
  return kSpanOfMedian * Median(&all);
}

}  // namespace oraclegs
