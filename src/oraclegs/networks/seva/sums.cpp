#include "oraclegs/networks/seva/sums.h"

#include "oraclegs/networks/seva/kernels.h"

namespace oraclegs::seva {
namespace {

void AddTo(const Addend& addend, Tensor* x) {
  if (addend.rows.defined()) x->add_(addend.rows.view(x->sizes()));
  if (!addend.vectors.defined()) return;
  const int64_t width = x->size(-1), groups = addend.vectors.numel() / width;
  x->view({groups, -1, width}).add_(addend.vectors.view({groups, 1, width}));
}

}  // namespace

Addend AddendOf(const Linear& layer, const Tensor& x) {
  if (!kernels::CanTake(x)) return {Forward(layer, x), {}};
  return {at::linear(x, layer.weight), layer.bias};
}

void Add(const Addend& addend, Tensor* x) {
  if (!kernels::Sum(*x, addend, x).defined()) AddTo(addend, x);
}

Tensor Sum(const Tensor& x, const Addend& addend) {
  Tensor sum;
  if (kernels::Sum(x, addend, &sum).defined()) return sum;
  sum = x.clone(at::MemoryFormat::Contiguous);
  AddTo(addend, &sum);
  return sum;
}

Tensor NormAfterAdding(const Addend& addend, const LayerNorm& norm, Tensor* x) {
  if (Tensor y = kernels::NormOfSum(*x, addend, norm, x); y.defined()) return y;
  AddTo(addend, x);
  return Forward(norm, *x);
}

Tensor NormOfSum(const Tensor& x, const Addend& addend, const LayerNorm& norm, Tensor* sum) {
  Tensor made;
  if (Tensor y = kernels::NormOfSum(x, addend, norm, &made); y.defined()) {
    *sum = made;
    return y;
  }
  *sum = x.clone(at::MemoryFormat::Contiguous);
  AddTo(addend, sum);
  return Forward(norm, *sum);
}

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
