#include "oraclegs/networks/seva/group_norm.h"

#include "oraclegs/networks/seva/kernels.h"
#include "oraclegs/networks/seva/slices.h"

namespace oraclegs::seva {
namespace {

/// libtorch's own would make a copy with the channels first. Sums are float32: of every channel, then of every group.
/// The factors are of x's type, and what is added makes up for their rounding, but is rounded itself.
Tensor NormalizedLast(const GroupNorm& layer, const Tensor& x) {
  const int64_t images = x.size(0), channels = x.size(1), groups = layer.groups, width = channels / groups;
  const Tensor pixels = x.permute({0, 2, 3, 1}).flatten(1, 2);
  const auto of_groups = [&](const Tensor& sums) {
    return sums.view({images, groups, width}).sum(-1, true) / static_cast<double>(pixels.size(1) * width);
  };
  const Tensor mean = of_groups(at::sum(pixels, {1}, false, torch::kFloat));
  const Tensor square = of_groups(at::linalg_vector_norm(pixels, 2, {1}, false, torch::kFloat).square_());
  const Tensor deviation = (square - mean.square()).clamp_min_(0).add_(layer.eps).sqrt_();
  const Tensor scale = (layer.weight.to(torch::kFloat).view({1, groups, width}) / deviation).to(x.scalar_type());
  const Tensor shift = layer.bias.to(torch::kFloat).view({1, groups, width}) - mean * scale;
  const Tensor out =
      at::addcmul(shift.to(x.scalar_type()).view({images, 1, channels}), pixels, scale.view({images, 1, channels}));
  return out.view({images, x.size(2), x.size(3), channels}).permute({0, 3, 1, 2});
}

/// In float32, but for what NormalizedLast does.
Tensor Normalized(const GroupNorm& layer, const Tensor& x) {
  if (layer.channels_last) return NormalizedLast(layer, x);
  return at::group_norm(x.to(torch::kFloat), layer.groups, layer.weight.to(torch::kFloat), layer.bias.to(torch::kFloat),
                        layer.eps);
}

/// The layer of some of the output channels.
Conv Channels(const Conv& layer, int64_t begin, int64_t end) {
  Conv some = layer;
  some.weight = layer.weight.slice(0, begin, end), some.bias = layer.bias.slice(0, begin, end);
  return some;
}

/// y (1 + scale) + shift in place, some frames at a time: scale and shift together are twice as wide as y. They come
/// from two products, since halves of one are strided, which a GPU reads at half the rate.
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
