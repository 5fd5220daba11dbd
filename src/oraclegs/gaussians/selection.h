#pragma once
// Some of the Gaussians of a model.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// The Gaussians of these indices, in this order, in new memory on the host.
Gaussians Picked(const Gaussians& gaussians, const std::vector<int64_t>& indices);

/// The rows of those indices, in their order, of any array on the host.
template <class T>
Buffer<T> PickedRows(const Buffer<T>& all, const std::vector<int64_t>& indices) {
  constexpr int64_t kGrain = 4096;  // rows
  const auto n = static_cast<int64_t>(indices.size());
  Buffer<T> picked = Buffer<T>::Empty(all.shape().WithRows(n));
  const int64_t row = all.shape().row();
  ParallelBlocks(n, kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) std::copy_n(all.data() + indices[i] * row, row, picked.data() + i * row);
  });
  return picked;
}

/// Marks that a run gives each Gaussian, numbers in [0, 1]; an empty list = unknown.
struct GaussianMarks {
  std::vector<float> support = {};      ///< how far the images support it (evaluate/support.h)
  std::vector<float> uncertainty = {};  ///< the error to expect of what it shows (evaluate/uncertainty.h)
};

/// The marks of these Gaussians, in this order.
GaussianMarks Picked(const GaussianMarks& marks, const std::vector<int64_t>& indices);

/// Those `most` of these Gaussians that cover and hide most (opacity times the area of the broadest side), in the order
/// given; all where there are no more. Among equals the first is taken. The Gaussians are on the host.
std::vector<int64_t> MostPresent(const Gaussians& gaussians, std::vector<int64_t> indices, int64_t most);

/// The rows of a model, in order, without its far dust: nearly transparent, small Gaussians that the noise of training
/// has carried more than twelve times the extent of the middle 99 % away from it. Nobody sees them, but programs that
/// frame a model by its box show a dot. All rows of fewer than 1000 Gaussians.
std::vector<int64_t> WithoutFarDust(const Gaussians& gaussians);

}  // namespace oraclegs
