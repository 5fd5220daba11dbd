#include "oraclegs/networks/common/rope.h"

#include <vector>

namespace oraclegs {

RopeTable MakeRopeTable(const RopeGrid& grid, int64_t width, double base) {
  if (width <= 0 || width % 4 != 0) throw ShapeError("MakeRopeTable: a head is {} wide, no multiple of 4", width);
  const int64_t tokens = grid.special + grid.rows * grid.cols;
  std::vector<float> positions(static_cast<size_t>(2 * tokens), 0.f);
  for (int64_t r = 0; r < grid.rows; ++r) {
    for (int64_t c = 0; c < grid.cols; ++c) {
      const size_t token = static_cast<size_t>(grid.special + r * grid.cols + c);
      positions[2 * token] = static_cast<float>(r + 1);
      positions[2 * token + 1] = static_cast<float>(c + 1);
    }
  }
  const int64_t half = width / 2;
  const Tensor exponents = torch::arange(0, half, 2, torch::kFloat) / static_cast<double>(half);
  const Tensor frequencies = at::pow(torch::scalar_tensor(base, torch::kFloat), exponents).reciprocal();
  const Tensor angles = torch::tensor(positions).view({tokens, 2, 1, 1}) * frequencies;
  return {angles.cos(), angles.sin()};
}

RopeTable Repeat(const RopeTable& table, int64_t views) {
  return {table.cos.repeat({views, 1, 1, 1}), table.sin.repeat({views, 1, 1, 1})};
}

Tensor Rotate(const RopeTable& table, const Tensor& t) {
  const int64_t quarter = t.size(3) / 4;
  // [B, heads, tokens, axis, first or second of the pair, frequency]
  const Tensor pairs = t.reshape({t.size(0), t.size(1), t.size(2), 2, 2, quarter});
  const Tensor first = pairs.slice(4, 0, 1), second = pairs.slice(4, 1, 2);
  const Tensor cos = table.cos.to(t.options()), sin = table.sin.to(t.options());
  return at::cat({first * cos - second * sin, second * cos + first * sin}, 4).reshape(t.sizes());
}

}  // namespace oraclegs
