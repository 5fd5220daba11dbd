#include "oraclegs/formats/codebook.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int kEntries = 256;
constexpr int kHistogram = 1 << 14, kDensityCells = 1 << 7;  // cells
constexpr int kLloydRounds = 30;
constexpr int kMeansRounds = 10;
constexpr float kSmallestWeight = 1e-3f;

/// Rows of `vectors` under some indices, and the centers that k-means finds for them.
class Clustering {
 public:
  Clustering(const Buffer<float>& vectors, const std::vector<float>& weights, std::vector<int64_t> rows, int centers)
      : vectors_(vectors), weights_(weights), rows_(std::move(rows)), dims_(vectors.shape().row()) {
    const auto count = std::min<int64_t>(centers, static_cast<int64_t>(rows_.size()));
    // Evenly from the rows: they stand in spatial order, so that this is a fair sample.
    for (int64_t k = 0; k < count; ++k) {
      const float* row = Row(static_cast<int64_t>(rows_.size()) * k / count);
      centers_.insert(centers_.end(), row, row + dims_);
    }
    labels_.assign(rows_.size(), 0);
  }

  /// With `parallel`, the assignment uses all threads.
  void Run(bool parallel) {
    for (int round = 0; round < kMeansRounds; ++round) {
      Assign(parallel);
      if (!Move()) break;
    }
    Assign(parallel);
  }

  int64_t count() const { return static_cast<int64_t>(centers_.size()) / dims_; }
  const std::vector<float>& centers() const { return centers_; }
  /// The indices that each center stands for.
  std::vector<std::vector<int64_t>> Members() const {
    std::vector<std::vector<int64_t>> members(static_cast<size_t>(count()));
    for (size_t i = 0; i < rows_.size(); ++i) members[labels_[i]].push_back(rows_[i]);
    return members;
  }

 private:
  const float* Row(int64_t i) const { return vectors_.data() + rows_[i] * dims_; }

  void Assign(bool parallel) {
    const auto assign = [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) labels_[i] = Nearest(Row(i));
    };
    const auto n = static_cast<int64_t>(rows_.size());
    if (parallel) {
      ParallelBlocks(n, 1024, assign);
    } else {
      assign(0, n);
    }
  }

  int Nearest(const float* row) const {
    int best = 0;
    float least = std::numeric_limits<float>::infinity();
    for (int64_t k = 0; k < count(); ++k) {
      const float* center = centers_.data() + k * dims_;
      float distance = 0;
      for (int64_t d = 0; d < dims_; ++d) distance += (row[d] - center[d]) * (row[d] - center[d]);
      if (distance < least) {
        least = distance;
        best = static_cast<int>(k);
      }
    }
    return best;
  }

  /// Moves the centers to the means of their rows; false when none has moved. A center without rows stays.
  bool Move() {
    std::vector<double> sums(centers_.size()), mass(static_cast<size_t>(count()));
    for (size_t i = 0; i < rows_.size(); ++i) {
      const double weight = std::max(weights_[rows_[i]], kSmallestWeight);
      const float* row = Row(static_cast<int64_t>(i));
      mass[labels_[i]] += weight;
      for (int64_t d = 0; d < dims_; ++d) sums[labels_[i] * dims_ + d] += weight * row[d];
    }
    bool moved = false;
    for (size_t j = 0; j < sums.size(); ++j) {
      const double m = mass[j / dims_];
      if (m == 0) continue;
      const auto center = static_cast<float>(sums[j] / m);
      moved = moved || center != centers_[j];
      centers_[j] = center;
    }
    return moved;
  }

  const Buffer<float>& vectors_;
  const std::vector<float>& weights_;
  std::vector<int64_t> rows_;
  int64_t dims_;
  std::vector<float> centers_;
  std::vector<int> labels_;
};

}  // namespace

std::vector<float> MakeCodebook(const std::vector<float>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (values.empty() || !(*high > *low)) return std::vector<float>(kEntries, values.empty() ? 0.f : *low);
  std::vector<double> counts(kHistogram), sums(kHistogram);
  const double scale = (kHistogram - 1) / (static_cast<double>(*high) - *low);
  for (const float v : values) {
    const auto cell = static_cast<size_t>((static_cast<double>(v) - *low) * scale);
    counts[cell] += 1;
    sums[cell] += v;
  }
  // The optimal density of entries grows with the cube root of the density of values, taken from broad cells: single
  // values in fine ones are no density.
  std::vector<double> density(kDensityCells);
  for (int cell = 0; cell < kHistogram; ++cell) density[cell / (kHistogram / kDensityCells)] += counts[cell];
  double all = 0;
  for (double& d : density) all += d = std::cbrt(d);
  std::vector<float> entries;
  double passed = 0;
  const double width = (static_cast<double>(*high) - *low) / kDensityCells;
  for (int cell = 0; cell < kDensityCells; ++cell) {
    double wanted = 0;
    while (entries.size() < kEntries &&
           (wanted = all * (static_cast<double>(entries.size()) + 0.5) / kEntries) <= passed + density[cell]) {
      entries.push_back(static_cast<float>(*low + (cell + (wanted - passed) / density[cell]) * width));
    }
    passed += density[cell];
  }
  entries.resize(kEntries, *high);
  for (int round = 0; round < kLloydRounds; ++round) {
    std::vector<double> entry_counts(kEntries), entry_sums(kEntries);
    for (int cell = 0; cell < kHistogram; ++cell) {
      if (counts[cell] == 0) continue;
      const uint8_t entry = NearestEntry(entries, static_cast<float>(sums[cell] / counts[cell]));
      entry_counts[entry] += counts[cell];
      entry_sums[entry] += sums[cell];
    }
    std::vector<float> moved = entries;
    for (int e = 0; e < kEntries; ++e) {
      if (entry_counts[e] > 0) moved[e] = static_cast<float>(entry_sums[e] / entry_counts[e]);
    }
    std::sort(moved.begin(), moved.end());
    if (moved == entries) break;
    entries = moved;
  }
  return entries;
}

uint8_t NearestEntry(const std::vector<float>& codebook, float value) {
  const auto above = std::lower_bound(codebook.begin(), codebook.end(), value);
  if (above == codebook.begin()) return 0;
  if (above == codebook.end() || value - *(above - 1) <= *above - value) {
    return static_cast<uint8_t>(above - codebook.begin() - 1);
  }
  return static_cast<uint8_t>(above - codebook.begin());
}

Palette MakePalette(const Buffer<float>& vectors, const std::vector<float>& weights, int size) {
  const int64_t n = vectors.size(0), dims = vectors.shape().row();
  std::vector<int64_t> rows(static_cast<size_t>(n));
  std::iota(rows.begin(), rows.end(), 0);
  // Flat k-means would compare every vector with every color; in two levels it is the square root of that.
  const int coarse = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(size)) / 2));
  Clustering first(vectors, weights, rows, coarse);
  first.Run(true);
  const std::vector<std::vector<int64_t>> groups = first.Members();
  std::vector<std::vector<float>> centers(groups.size());
  std::vector<std::vector<std::vector<int64_t>>> members(groups.size());
  ParallelFor(static_cast<int64_t>(groups.size()), [&](int64_t g) {
    if (groups[g].empty()) return;
    const auto share = static_cast<double>(groups[g].size()) / static_cast<double>(n);
    Clustering second(vectors, weights, groups[g], std::max(1, static_cast<int>(share * (size - coarse))));
    second.Run(false);
    centers[g] = second.centers();
    members[g] = second.Members();
  });
  std::vector<float> colors;
  Palette palette;
  palette.labels.resize(static_cast<size_t>(n));
  for (size_t g = 0; g < groups.size(); ++g) {
    for (size_t k = 0; k < members[g].size(); ++k) {
      if (members[g][k].empty()) continue;
      const size_t label = colors.size() / dims;
      for (const int64_t i : members[g][k]) palette.labels[i] = static_cast<uint16_t>(label);
      colors.insert(colors.end(), centers[g].begin() + static_cast<int64_t>(k) * dims,
                    centers[g].begin() + static_cast<int64_t>(k + 1) * dims);
    }
  }
  palette.colors = Buffer<float>::From({static_cast<int64_t>(colors.size()) / dims, dims}, colors);
  return palette;
}

}  // namespace oraclegs
