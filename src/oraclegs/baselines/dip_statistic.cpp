#include "oraclegs/baselines/mode_floaters.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace oraclegs {
namespace {

using Vertices = std::vector<int64_t>;  ///< ascending places in the sample

/// A sorted sample. Point i is (x_i, i + 1): the distribution function in counts; just left of x_i it is i.
class SortedSample {
 public:
  explicit SortedSample(std::vector<float> sample) : x_(std::move(sample)) {
    std::sort(x_.begin(), x_.end());
    const auto n = static_cast<int64_t>(x_.size());
    // The vertex beside i of the lower hull of points 0..i, and of the upper hull of points i..n - 1. Hulls of any
    // range of the sample follow from these.
    left_.resize(x_.size());
    for (int64_t i = 1; i < n; ++i) {
      left_[i] = i - 1;
      while (left_[i] > 0 && !TurnsUp(left_[left_[i]], left_[i], i)) left_[i] = left_[left_[i]];
    }
    right_.resize(x_.size());
    for (int64_t i = n - 2; i >= 0; --i) {
      right_[i] = i + 1;
      while (right_[i] < n - 1 && !TurnsDown(i, right_[i], right_[right_[i]])) right_[i] = right_[right_[i]];
    }
  }

  int64_t size() const { return static_cast<int64_t>(x_.size()); }

  /// Vertices of the greatest convex minorant (Majorant: least concave majorant) of points [low, high].
  Vertices Minorant(int64_t low, int64_t high) const {
    Vertices vertices = {high};
    while (vertices.back() > low) vertices.push_back(left_[vertices.back()]);
    std::reverse(vertices.begin(), vertices.end());
    return vertices;
  }
  Vertices Majorant(int64_t low, int64_t high) const {
    Vertices vertices = {low};
    while (vertices.back() < high) vertices.push_back(right_[vertices.back()]);
    return vertices;
  }

  /// Height, in counts, of the line through two points over point `at`; an upright line has the height of its lower
  /// end.
  double Line(int64_t from, int64_t to, int64_t at) const {
    const double fraction = Width(from, to) > 0 ? Width(from, at) / Width(from, to) : 0;
    return static_cast<double>(from + 1) + fraction * Rise(from, to);
  }

 private:
  double Wide(int64_t i) const { return static_cast<double>(x_[i]); }
  /// Whether the slope grows (TurnsDown: falls) at b. Needs no division, since points may coincide.
  bool TurnsUp(int64_t a, int64_t b, int64_t c) const { return Width(a, b) * Rise(b, c) > Width(b, c) * Rise(a, b); }
  bool TurnsDown(int64_t a, int64_t b, int64_t c) const { return Width(a, b) * Rise(b, c) < Width(b, c) * Rise(a, b); }
  double Width(int64_t from, int64_t to) const { return Wide(to) - Wide(from); }
  static double Rise(int64_t from, int64_t to) { return static_cast<double>(to - from); }

  std::vector<float> x_;
  Vertices left_, right_;
};

/// The place where the two hulls of a range are farthest apart, and the range left between the minorant's vertex at or
/// before it and the majorant's at or behind it.
struct WidestGap {
  double gap = 1;  ///< in counts; at least 1, the gap at the ends
  int64_t low, high;
};

WidestGap FindWidestGap(const SortedSample& sample, const Vertices& minorant, const Vertices& majorant) {
  WidestGap widest{1, minorant.front(), majorant.back()};
  // The gap is concave between vertices of either hull, so one of them is where it is widest.
  const int64_t high = majorant.back();
  size_t i = 1, j = 1;  // the vertices that come next; between them and the ones before them lies the place looked at
  while (minorant[i] < high || majorant[j] < high) {
    if (majorant[j] < minorant[i]) {
      const int64_t at = majorant[j++];
      const double gap = static_cast<double>(at + 2) - sample.Line(minorant[i - 1], minorant[i], at);
      if (gap >= widest.gap) widest = {gap, minorant[i - 1], at};
    } else {
      const int64_t at = minorant[i++];
      const double gap = sample.Line(majorant[j - 1], majorant[j], at) - static_cast<double>(at);
      if (gap >= widest.gap) widest = {gap, at, majorant[j]};
    }
  }
  return widest;
}

/// The largest distance, in counts, of the distribution function from the minorant over points up to `high`, along the
/// given vertices; at least 1 where there is a segment.
double DistanceFromMinorant(const SortedSample& sample, const Vertices& vertices, int64_t high) {
  double largest = 0;
  for (size_t k = 1; k < vertices.size() && vertices[k] <= high; ++k) {
    largest = std::max(largest, 1.0);
    for (int64_t at = vertices[k - 1]; at <= vertices[k]; ++at) {
      largest = std::max(largest, static_cast<double>(at + 2) - sample.Line(vertices[k - 1], vertices[k], at));
    }
  }
  return largest;
}

/// The largest distance, in counts, of the distribution function from the majorant over points from `low` on.
double DistanceFromMajorant(const SortedSample& sample, const Vertices& vertices, int64_t low) {
  double largest = 0;
  for (size_t k = 1; k < vertices.size(); ++k) {
    if (vertices[k - 1] < low) continue;
    largest = std::max(largest, 1.0);
    for (int64_t at = vertices[k - 1]; at <= vertices[k]; ++at) {
      largest = std::max(largest, sample.Line(vertices[k - 1], vertices[k], at) - static_cast<double>(at));
    }
  }
  return largest;
}

}  // namespace

double DipStatistic(std::vector<float> numbers) {
  if (numbers.empty()) return 0;
  const SortedSample sample(std::move(numbers));
  const int64_t n = sample.size();
  // The interval that holds the mode shrinks; what is cut off on its left must be convex, on its right concave.
  int64_t low = 0, high = n - 1;
  double twice_dip = 1;  // in counts
  while (low < high) {
    const Vertices minorant = sample.Minorant(low, high), majorant = sample.Majorant(low, high);
    const WidestGap widest = FindWidestGap(sample, minorant, majorant);
    if (widest.gap <= twice_dip) break;  // inside, the function need not bend more than it already must
    twice_dip = std::max({twice_dip, DistanceFromMinorant(sample, minorant, widest.low),
                          DistanceFromMajorant(sample, majorant, widest.high)});
    if (widest.low == low && widest.high == high) break;
    low = widest.low;
    high = widest.high;
  }
  return twice_dip / static_cast<double>(2 * n);
}

}  // namespace oraclegs
