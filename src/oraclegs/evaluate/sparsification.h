#pragma once
// Sparsification: how fast the mean error falls when the least certain pixels are removed first.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "oraclegs/evaluate/pixel_errors.h"

namespace oraclegs {

/// Mean over m = 1 .. n of the mean error of the m pixels that are kept longest. `removed`: order of removal, by `key`.
/// Pixels of equal key leave in random order, so each has the mean error of its tie.
double SparsificationArea(const std::vector<float>& error, const std::vector<float>& key,
                          const std::vector<int64_t>& removed);

/// Areas under the sparsification error as other papers compute it [Shen 2022], [Goli 2024]: 0, 1, ... 99 % of the
/// pixels are removed, the curve and that of the ideal order are divided by the largest value of both, and the area
/// between them is taken by trapezoids. NaN without pixels.
struct PublishedAuse {
  double mae = 0, rmse = 0, dssim = 0;  ///< by the error that is averaged
};

/// The areas for the pixels of all images together. doubts: of each image's pixels, larger = less certain.
PublishedAuse PooledAuse(const std::vector<PixelErrors>& images, const std::vector<std::vector<float>>& doubts);
/// The mean of the areas of each image that has pixels.
PublishedAuse MeanAuse(const std::vector<PixelErrors>& images, const std::vector<std::vector<float>>& doubts);

/// {"mae", "rmse", "dssim"}; NaN becomes null.
nlohmann::json ToJson(const PublishedAuse& ause);

}  // namespace oraclegs
