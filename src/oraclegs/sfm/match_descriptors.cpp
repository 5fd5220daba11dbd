#include "oraclegs/sfm/match_descriptors.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kRowsATask = 128;

using Rows = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// The two most similar descriptors (cosines) of another image.
struct Nearest {
  float best = -std::numeric_limits<float>::infinity(), second = best;
  uint32_t index = 0;

  void Add(float similarity, uint32_t of) {
    if (similarity > best) {
      second = best;
      best = similarity;
      index = of;
    } else {
      second = std::max(second, similarity);
    }
  }

  /// Takes in another's, which are of higher indices.
  void Add(const Nearest& other) {
    Add(other.best, other.index);
    second = std::max(second, other.second);
  }

  /// Squared distances of vectors of unit length are 2 - 2 cos, which rounding may bring below zero.
  bool IsClear(double max_ratio) const {
    return std::max(0.f, 1 - best) < max_ratio * max_ratio * std::max(0.f, 1 - second);
  }
};

}  // namespace

std::vector<FeatureMatch> MatchDescriptors(const Buffer<float>& a, const Buffer<float>& b, double max_ratio) {
  RequireShape("MatchDescriptors", "a", a, {-1, -1});
  RequireShape("MatchDescriptors", "b", b, {-1, a.size(1)});
  if (a.size(0) == 0 || b.size(0) == 0) return {};
  const Rows from(a.data(), a.size(0), a.size(1)), to(b.data(), b.size(0), b.size(1));
  std::vector<Nearest> of_a(static_cast<size_t>(a.size(0)));
  const int64_t tasks = (a.size(0) + kRowsATask - 1) / kRowsATask;
  std::vector<std::vector<Nearest>> of_b(static_cast<size_t>(tasks));
  ParallelFor(tasks, [&](int64_t task) {
    const int64_t begin = task * kRowsATask, rows = std::min(kRowsATask, a.size(0) - begin);
    const Eigen::MatrixXf similarities = from.middleRows(begin, rows) * to.transpose();  // a column for each of b
    std::vector<Nearest>& columns = of_b[static_cast<size_t>(task)];
    columns.resize(static_cast<size_t>(b.size(0)));
    for (int64_t j = 0; j < b.size(0); ++j) {
      for (int64_t i = 0; i < rows; ++i) {
        const float similarity = similarities(i, j);
        of_a[static_cast<size_t>(begin + i)].Add(similarity, static_cast<uint32_t>(j));
        columns[static_cast<size_t>(j)].Add(similarity, static_cast<uint32_t>(begin + i));
      }
    }
  });
  for (size_t task = 1; task < of_b.size(); ++task) {
    for (size_t j = 0; j < of_b[0].size(); ++j) of_b[0][j].Add(of_b[task][j]);
  }
  std::vector<FeatureMatch> matches;
  for (size_t i = 0; i < of_a.size(); ++i) {
    const Nearest& back = of_b[0][of_a[i].index];
    if (back.index != i || !of_a[i].IsClear(max_ratio) || !back.IsClear(max_ratio)) continue;
    matches.push_back({static_cast<uint32_t>(i), of_a[i].index});
  }
  return matches;
}

}  // namespace oraclegs
