#include "oraclegs/networks/common/grid_embedding.h"

#include <cmath>

namespace oraclegs {
namespace {

/// Sines and cosines, [quarter, n] each, of n places between -extent and extent.
std::pair<Tensor, Tensor> Waves(double extent, int64_t n, const Tensor& frequencies) {
  const double last = extent * static_cast<double>(n - 1) / static_cast<double>(n);
  const Tensor places = torch::linspace(-last, last, n, torch::kFloat).to(torch::kDouble);
  const Tensor angles = frequencies.unsqueeze(1) * places;
  return {angles.sin().to(torch::kFloat), angles.cos().to(torch::kFloat)};
}

}  // namespace

Tensor GridEmbedding(int64_t channels, int64_t rows, int64_t cols, double aspect) {
  if (channels <= 0 || channels % 4 != 0 || rows <= 0 || cols <= 0) {
    throw ShapeError("GridEmbedding: {} channels on {} x {}, expected a multiple of 4 and a map", channels, rows, cols);
  }
  const int64_t quarter = channels / 4;
  const Tensor exponents = torch::arange(quarter, torch::kDouble) / static_cast<double>(quarter);
  const Tensor frequencies = at::pow(torch::scalar_tensor(100.0, torch::kDouble), -exponents);
  const double diagonal = std::sqrt(aspect * aspect + 1);
  const auto [sin_x, cos_x] = Waves(aspect / diagonal, cols, frequencies);
  const auto [sin_y, cos_y] = Waves(1 / diagonal, rows, frequencies);
  const auto along_x = [&](const Tensor& t) { return t.unsqueeze(1).expand({quarter, rows, cols}); };
  const auto along_y = [&](const Tensor& t) { return t.unsqueeze(2).expand({quarter, rows, cols}); };
  return at::cat({along_x(sin_x), along_x(cos_x), along_y(sin_y), along_y(cos_y)}, 0);
}

}  // namespace oraclegs
