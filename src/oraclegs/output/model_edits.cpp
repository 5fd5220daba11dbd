#include "oraclegs/output/model_edits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/gaussians/neighbors.h"

namespace oraclegs {
namespace {

constexpr double kOutlier = 3.5;            // robust standard deviations
constexpr double kDeviationOfMad = 1.4826;  // standard deviation of a normal distribution over its MAD
constexpr double kLeastSpread = 0.2;        // in the logarithm; a regular grid has no deviation at all
constexpr double kReach = 3;                // standard deviations of a Gaussian within which it is visible
constexpr double kNearest = 1e-12;          // distances of duplicates have no logarithm

/// Numbers of "1,2.5,-3"; empty for any other text.
std::vector<double> NumbersOf(std::string_view text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at <= end) {
    double value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value) || (stop != end && *stop != ',')) return {};
    numbers.push_back(value);
    at = stop + 1;
  }
  return numbers;
}

}  // namespace

bool Crop::Holds(const Eigen::Vector3d& point) const {
  if (kind == Kind::kBox) return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  return kind != Kind::kBall || (point - ball.center).norm() <= ball.radius;
}

Crop Crop::MovedBy(const Eigen::Vector3d& way) const {
  Crop moved = *this;
  moved.low += way, moved.high += way, moved.ball.center += way;
  return moved;
}

Crop ParseCrop(const std::string& text) {
  Crop crop;
  if (text.empty()) return crop;
  if (text == "auto") {
    crop.kind = Crop::Kind::kAuto;
    return crop;
  }
  const size_t colon = std::min(text.find(':'), text.size());
  const std::string kind = text.substr(0, colon);
  const std::vector<double> n = NumbersOf(std::string_view(text).substr(std::min(colon + 1, text.size())));
  if (kind == "box" && n.size() == 6) {
    crop.kind = Crop::Kind::kBox;
    crop.low = Eigen::Vector3d(std::min(n[0], n[3]), std::min(n[1], n[4]), std::min(n[2], n[5]));
    crop.high = Eigen::Vector3d(std::max(n[0], n[3]), std::max(n[1], n[4]), std::max(n[2], n[5]));
    return crop;
  }
  if (kind == "sphere" && n.size() == 4 && n[3] > 0) {
    crop.kind = Crop::Kind::kBall;
    crop.ball = {{n[0], n[1], n[2]}, n[3]};
    return crop;
  }
  throw UsageError("--crop is '{}', must be auto, box:x0,y0,z0,x1,y1,z1 or sphere:x,y,z,radius with a radius above 0",
                   text);
}

std::vector<int64_t> HeldBy(const Crop& crop, const Gaussians& gaussians, const Similarity& crop_from_gaussians) {
  const Buffer<float> means = gaussians.means.To(kCpu);
  std::vector<int64_t> held;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    const Eigen::Vector3d mean = Eigen::Map<const Eigen::Vector3f>(means.data() + 3 * i).cast<double>();
    if (crop.Holds(crop_from_gaussians * mean)) held.push_back(i);
  }
  return held;
}

std::optional<Eigen::Vector3d> ParseAxis(const std::string& text) {
  if (text.empty() || text == "auto") return std::nullopt;
  const bool negative = text[0] == '-';
  const size_t axis = text.size() == (negative ? 2u : 1u) ? std::string_view("xyz").find(text.back()) : 3;
  if (axis > 2) throw UsageError("--up is '{}', must be one of: auto, x, -x, y, -y, z, -z", text);
  return (negative ? -1.0 : 1.0) * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis));
}

std::vector<bool> OutlierGaussians(const Gaussians& gaussians) {
  const int64_t n = gaussians.size();
  std::vector<Eigen::Vector3f> points;
  for (int64_t i = 0; i < n; ++i) points.emplace_back(gaussians.means.data() + 3 * i);
  const std::vector<double> squares = KdTree(points).MeanSquaredDistanceToThree();
  std::vector<double> logs;
  for (const double s : squares) logs.push_back(std::log(std::max(std::sqrt(s), kNearest)));
  const double middle = Median(logs);
  std::vector<double> deviations;
  for (const double l : logs) deviations.push_back(std::abs(l - middle));
  const double limit = middle + kOutlier * std::max(kDeviationOfMad * Median(&deviations), kLeastSpread);
  std::vector<bool> outlier;
  for (int64_t i = 0; i < n; ++i) {
    const float* s = gaussians.log_scales.data() + 3 * i;
    const double reach = std::log(kReach) + std::max({s[0], s[1], s[2]});
    outlier.push_back(n > 1 && logs[i] > limit && logs[i] > reach);
  }
  return outlier;
}

Eigen::Matrix3d TurnBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to).normalized().toRotationMatrix();
}

}  // namespace oraclegs
