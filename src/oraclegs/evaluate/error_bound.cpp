#include "oraclegs/evaluate/error_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

int ClassOf(float expected) {
  return static_cast<int>(std::upper_bound(kClassFrom.begin(), kClassFrom.end(), static_cast<double>(expected)) -
                          kClassFrom.begin());
}

void CheckLengths(const ExpectedErrors& image) {
  if (image.error.size() != image.expected.size()) {
    throw ShapeError("ErrorBound: {} errors of {} pixels", image.error.size(), image.expected.size());
  }
}

struct WeightedError {
  float error;
  double weight;
};

/// The error that kBoundShare of the weight does not exceed.
double Quantile(std::vector<WeightedError> errors) {
  std::sort(errors.begin(), errors.end(),
            [](const WeightedError& a, const WeightedError& b) { return a.error < b.error; });
  double all = 0, sum = 0;
  for (const WeightedError& e : errors) all += e.weight;
  for (const WeightedError& e : errors) {
    sum += e.weight;
    if (sum >= kBoundShare * all) return static_cast<double>(e.error);
  }
  return static_cast<double>(errors.back().error);
}

}  // namespace

ErrorBound BoundFrom(const std::vector<ExpectedErrors>& photos) {
  std::array<std::vector<WeightedError>, kCertaintyClasses> of_classes;
  std::array<int, kCertaintyClasses> photos_of = {};
  ErrorBound bound;
  for (const ExpectedErrors& photo : photos) {
    CheckLengths(photo);
    if (photo.error.empty()) continue;
    ++bound.photos;
    std::array<double, kCertaintyClasses> counts = {};
    for (const float expected : photo.expected) ++counts[static_cast<size_t>(ClassOf(expected))];
    for (size_t c = 0; c < kCertaintyClasses; ++c) photos_of[c] += counts[c] > 0 ? 1 : 0;
    for (size_t i = 0; i < photo.error.size(); ++i) {
      const auto c = static_cast<size_t>(ClassOf(photo.expected[i]));
      of_classes[c].push_back({photo.error[i], 1 / counts[c]});
    }
  }
  for (size_t c = 0; c < kCertaintyClasses; ++c) {
    bound.below[c] = photos_of[c] < kMinBoundPhotos ? kUnknown : Quantile(std::move(of_classes[c]));
  }
  return bound;
}

BoundCheck CheckBound(const ErrorBound& bound, const std::vector<ExpectedErrors>& images) {
  BoundCheck check;
  double all = 0;
  for (const ExpectedErrors& image : images) {
    CheckLengths(image);
    for (size_t i = 0; i < image.error.size(); ++i) {
      const auto c = static_cast<size_t>(ClassOf(image.expected[i]));
      ++check.share[c], ++all;
      check.covered[c] += static_cast<double>(image.error[i]) <= bound.below[c] ? 1 : 0;
    }
  }
  for (size_t c = 0; c < kCertaintyClasses; ++c) {
    const bool is_known = check.share[c] > 0 && !std::isnan(bound.below[c]);
    check.covered[c] = is_known ? check.covered[c] / check.share[c] : kUnknown;
    check.share[c] /= std::max(1.0, all);
  }
  return check;
}

nlohmann::json ToJson(const ErrorBound& bound, const BoundCheck* check) {
  const auto number = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); };
  nlohmann::json classes = nlohmann::json::array();
  for (size_t c = 0; c < kCertaintyClasses; ++c) {
    nlohmann::json row = {{"from", c == 0 ? 0.0 : kClassFrom[c - 1]},
                          {"to", c + 1 == kCertaintyClasses ? 1.0 : kClassFrom[c]},
                          {"below", number(bound.below[c])}};
    if (check != nullptr) row["pixels"] = check->share[c], row["covered"] = number(check->covered[c]);
    classes.push_back(std::move(row));
  }
  return {{"photos", bound.photos}, {"share", kBoundShare}, {"classes", std::move(classes)}};
}

}  // namespace oraclegs
