#include "oraclegs/networks/seva/group_norm.h"

namespace oraclegs::seva {
namespace {

/// In float32.
Tensor Normalized(const GroupNorm& layer, const Tensor& x) {
  return at::group_norm(x.to(torch::kFloat), layer.groups, layer.weight.to(torch::kFloat), layer.bias.to(torch::kFloat),
                        layer.eps);
}

}  // namespace

GroupNorm LoadGroupNorm(const ParameterScope& at, int64_t channels, int64_t groups, double eps) {
  if (groups <= 0 || channels % groups != 0) {
    throw ShapeError("LoadGroupNorm: {} groups do not divide {} channels", groups, channels);
  }
  return {at.Get("weight", {channels}), at.Get("bias", {channels}), groups, eps};
}

Tensor Forward(const GroupNorm& layer, const Tensor& x) { return Normalized(layer, x).to(x.scalar_type()); }

Tensor NormThenSilu(const GroupNorm& layer, const Tensor& x) {
  Tensor y = Normalized(layer, x);
  return at::silu_(y).to(x.scalar_type());
}

}  // namespace oraclegs::seva
