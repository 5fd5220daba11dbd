#include "oraclegs/train/rows.h"

#include <algorithm>

namespace oraclegs {

Buffer<float> GrowRows(const Buffer<float>& t, int64_t rows) {
  if (rows == t.size(0)) return t;
  std::vector<int64_t> shape = t.shape().vec();
  int64_t row = 1;
  for (size_t i = 1; i < shape.size(); ++i) row *= shape[i];
  shape[0] = rows;
  const auto bytes = static_cast<size_t>(rows * row) * t.element_size();
  if (t.storage_offset() == 0 && t.is_contiguous() && t.storage().nbytes() >= bytes) {
    return t.as_strided(shape, t.strides());
  }
  shape[0] = std::max(rows, t.size(0) + t.size(0) / 2);
  const Buffer<float> grown = torch::empty(shape, t.options());
  grown.narrow(0, 0, t.size(0)).copy_(t);
  return grown.narrow(0, 0, rows);
}

void GrowRows(Gaussians* gaussians, int64_t rows) {
  gaussians->ForEach([&](const char*, Buffer<float>& t) { t = GrowRows(t, rows); });
}

Gaussians Clone(const Gaussians& gaussians) {
  Gaussians copy = gaussians;
  copy.ForEach([](const char*, Buffer<float>& t) { t = t.Clone(); });
  return copy;
}

}  // namespace oraclegs
