#include "oraclegs/networks/seva/norms.h"

#include "oraclegs/networks/seva/kernels.h"
#include "oraclegs/networks/seva/slices.h"

namespace oraclegs::seva {
namespace {

/// Group norm in float32.
Tensor Normalized(const GroupNorm& layer, const Tensor& x) {
  const Tensor y = at::group_norm(x.to(torch::kFloat), layer.groups, layer.weight.to(torch::kFloat),
                                  layer.bias.to(torch::kFloat), layer.eps);
  return layer.channels_last ? y.contiguous(at::MemoryFormat::ChannelsLast) : y;
}

/// Layer that computes output channels begin to end - 1 alone.
Conv Channels(const Conv& layer, int64_t begin, int64_t end) {
  Conv some = layer;
  some.weight = layer.weight.slice(0, begin, end), some.bias = layer.bias.slice(0, begin, end);
  return some;
}

/// y (1 + scale) + shift in place, some frames at a time: scale and shift together are twice as wide as y. They come
/// from two products, since the halves of one are strided, which a GPU reads at half the rate.
void Modulate(const Conv& layer, const Tensor& dense, Tensor* y) {
  const int64_t frames = y->size(0), channels = y->size(1);
  const int64_t step = RowsAtOnce(*y, 2 * channels * y->size(2) * y->size(3));
  const Conv to_scale = Channels(layer, 0, channels), to_shift = Channels(layer, channels, 2 * channels);
  for (int64_t begin = 0; begin < frames; begin += step) {
    const int64_t end = std::min(begin + step, frames);
    const Tensor rays = dense.slice(0, begin, end), scale = Forward(to_scale, rays).add_(1);
    Tensor part = y->slice(0, begin, end);
    at::addcmul_out(part, Forward(to_shift, rays), part, scale);
  }
}

}  // namespace

GroupNorm LoadGroupNorm(const ParameterScope& at, int64_t channels, int64_t groups, double eps) {
  if (groups <= 0 || channels % groups != 0) {
    throw ShapeError("LoadGroupNorm: {} groups do not divide {} channels", groups, channels);
  }
  return {at.Get("weight", {channels}), at.Get("bias", {channels}), groups, eps};
}

Tensor Forward(const GroupNorm& layer, const Tensor& x) {
  if (Tensor y = kernels::NormMap(layer, x, false, {}); y.defined()) return y;
  return Normalized(layer, x).to(x.scalar_type());
}

Tensor NormThenSilu(const GroupNorm& layer, const Tensor& x) {
  if (Tensor y = kernels::NormMap(layer, x, true, {}); y.defined()) return y;
  Tensor y = Normalized(layer, x);
  return at::silu_(y).to(x.scalar_type());
}

Tensor NormThenSilu(const GroupNorm& layer, Tensor x, const AroundNorm& around) {
  if (Tensor y = kernels::NormMap(layer, x, true, around); y.defined()) return y;
  if (around.offsets.defined()) x.add_(around.offsets.unsqueeze(-1).unsqueeze(-1));
  Tensor y = NormThenSilu(layer, x);
  if (around.modulation != nullptr) Modulate(*around.modulation, around.rays, &y);
  return y;
}

}  // namespace oraclegs::seva
