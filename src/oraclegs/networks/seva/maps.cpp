#include "oraclegs/networks/seva/maps.h"

#include "oraclegs/networks/seva/kernels.h"
#include "oraclegs/networks/seva/sums.h"

namespace oraclegs::seva {

Conv WithoutBias(const Conv& layer) {
  Conv bare = layer;
  bare.bias = Tensor();
  return bare;
}

Tensor SumOfMaps(const Tensor& x, const Tensor& added, const Tensor& vector) {
  const auto rows = [](const Tensor& map) { return map.defined() ? map.permute({0, 2, 3, 1}) : map; };
  return Sum(rows(x), {rows(added), vector}).permute({0, 3, 1, 2});
}

Tensor ConvolveMap(const Conv& layer, const Tensor& x) {
  if (!layer.channels_last || !kernels::CanTake(x)) return Forward(layer, x);
  return SumOfMaps(Forward(WithoutBias(layer), x), {}, layer.bias);
}

}  // namespace oraclegs::seva
