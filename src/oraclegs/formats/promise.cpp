#include "oraclegs/formats/promise.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/values.h"

namespace oraclegs {
namespace {

constexpr double kShareOfSize = 0.25, kShareOfDistance = 1e-3;
constexpr double kRoom = 1.001;  // for rounding
constexpr float kLeastCosine = 0.98f, kOpacityError = 1.f / 500, kRounding = 1e-5f;

/// Units that errors are measured in.
struct SceneMeasure {
  explicit SceneMeasure(const Gaussians& g) {
    const auto n = static_cast<size_t>(g.size());
    std::vector<float> values(n);
    for (size_t c = 0; c < 3; ++c) {
      for (size_t i = 0; i < n; ++i) values[i] = g.means[3 * i + c];
      middle[c] = Median(&values);
    }
    for (size_t i = 0; i < n; ++i) {
      const float* s = g.log_scales.data() + 3 * i;
      values[i] = std::max(std::min(s[0], s[1]), std::min(std::max(s[0], s[1]), s[2]));
    }
    deviation = std::exp(double{Median(&values)});
  }

  double middle[3];
  double deviation;  // of the median Gaussian
};

enum class Kept : char { kWhole, kCut, kLost };

class PromiseChecker {
 public:
  PromiseChecker(const Gaussians& given, const SplatPromise& promise) : measure_(given), promise_(promise) {}

  /// Compares a Gaussian before and after; returns the reason where it is lost.
  Kept Look(const GaussianRows& given, const GaussianRows& read, std::string* why) const {
    const float* s = given.log_scales;
    const double seen = kRoom * std::max(measure_.deviation, std::exp(double{std::max({s[0], s[1], s[2]})}));
    if (!IsAtItsPlace(given, read, seen, why) || !HasItsShape(given, read, seen, why)) return Kept::kLost;
    bool cut = false;
    for (int k = 0; k < kShFloats; ++k) {
      const bool constant = k < 3;
      const float factor = constant ? static_cast<float>(kConstantSh) : 1, offset = constant ? 0.5f : 0;
      const float low = constant ? promise_.lowest_color : -promise_.largest_harmonic;
      const float high = constant ? promise_.highest_color : promise_.largest_harmonic;
      const float error = (constant ? promise_.color : promise_.harmonic) + kRounding;
      const float wanted = given.sh[k] * factor + offset, within = std::clamp(wanted, low, high);
      // The rounding of a float grows with the number.
      if (!(std::abs(read.sh[k] * factor + offset - within) <= error + kRounding * std::abs(within))) {
        if (why != nullptr) *why = fmt::format("its color {:.3g} becomes {:.3g}", wanted, read.sh[k] * factor + offset);
        return Kept::kLost;
      }
      cut = cut || (high > low && std::abs(wanted - within) > error);
    }
    return cut ? Kept::kCut : Kept::kWhole;
  }

 private:
  bool IsAtItsPlace(const GaussianRows& given, const GaussianRows& read, double seen, std::string* why) const {
    double distance = 0, off = 0;
    for (int c = 0; c < 3; ++c) {
      distance = std::max(distance, std::abs(given.means[c] - measure_.middle[c]));
      off = std::max(off, std::abs(double{given.means[c]} - double{read.means[c]}));
    }
    if (off <= std::max(promise_.position * seen, kShareOfDistance * distance)) return true;
    if (why != nullptr) *why = fmt::format("it is moved by {:.3g}", off);
    return false;
  }

  bool HasItsShape(const GaussianRows& given, const GaussianRows& read, double seen, std::string* why) const {
    for (int c = 0; c < 3; ++c) {
      const double wanted = given.log_scales[c], got = read.log_scales[c];
      if (std::abs(wanted - got) <= promise_.log_scale + kRounding) continue;
      if (std::exp(std::max(wanted, got)) < kShareOfSize * seen) continue;  // never of an infinite one
      if (why != nullptr) {
        *why = fmt::format("its standard deviation {:.3g} becomes {:.3g}", std::exp(wanted), std::exp(got));
      }
      return false;
    }
    const std::array<float, 4> p = UnitQuaternion(given.quats), q = UnitQuaternion(read.quats);
    if (!(std::abs(p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]) >= kLeastCosine)) {
      if (why != nullptr) *why = "its rotation is another one";
      return false;
    }
    const float wanted = Sigmoid(*given.opacity_logits), got = Sigmoid(*read.opacity_logits);
    if (std::abs(wanted - got) <= kOpacityError) return true;
    if (why != nullptr) *why = fmt::format("its opacity {:.3g} becomes {:.3g}", wanted, got);
    return false;
  }

  const SceneMeasure measure_;
  const SplatPromise promise_;
};

}  // namespace

PromiseCheck CheckPromise(const Gaussians& given, const Gaussians& read, const SplatPromise& promise) {
  const PromiseChecker checker(given, promise);
  const GaussianRows from = given.Rows(), to = read.Rows();
  std::vector<Kept> kept(static_cast<size_t>(given.size()));
  ParallelBlocks(given.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) kept[i] = checker.Look(from.From(i), to.From(i), nullptr);
  });
  PromiseCheck check;
  for (int64_t i = 0; i < given.size(); ++i) {
    check.cut += kept[i] == Kept::kCut ? 1 : 0;
    if (kept[i] == Kept::kLost) check.lost.push_back(i);
  }
  if (!check.lost.empty()) {
    const GaussianRows first = from.From(check.lost[0]);
    std::string why;
    checker.Look(first, to.From(check.lost[0]), &why);
    check.first =
        fmt::format("of the one at ({:.6g}, {:.6g}, {:.6g}), {}", first.means[0], first.means[1], first.means[2], why);
  }
  return check;
}

}  // namespace oraclegs
