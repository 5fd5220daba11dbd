#include "oraclegs/networks/seva/res_block.h"

#include "oraclegs/networks/seva/slices.h"

namespace oraclegs::seva {
namespace {

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

ResBlock LoadResBlock(const ParameterScope& at, const ResShape& shape) {
  ResBlock block;
  block.norm_in = LoadGroupNorm(at / "in_layers" / 0, shape.in, shape.groups, 1e-5);
  block.conv_in = LoadConv(at / "in_layers" / 2, {shape.in, shape.out});
  block.embedding = LoadLinear(at / "emb_layers" / 1, shape.embedding, shape.out);
  block.dense = LoadConv(at / "dense_emb_layers" / 0, {shape.dense, 2 * shape.in, 1, 1, 0});
  block.norm_out = LoadGroupNorm(at / "out_layers" / 0, shape.out, shape.groups, 1e-5);
  block.conv_out = LoadConv(at / "out_layers" / 3, {shape.out, shape.out});
  if (shape.in != shape.out) block.skip = LoadConv(at / "skip_connection", {shape.in, shape.out, 1, 1, 0});
  return block;
}

Tensor Forward(const ResBlock& block, const Tensor& x, const Tensor& embedding, const Tensor& dense) {
  Tensor y = NormThenSilu(block.norm_in, x);
  Modulate(block.dense, dense, &y);
  y = Forward(block.conv_in, y);
  y.add_(Forward(block.embedding, embedding).unsqueeze(-1).unsqueeze(-1));
  y = Forward(block.conv_out, NormThenSilu(block.norm_out, y));
  return y.add_(block.skip ? Forward(*block.skip, x) : x);
}

}  // namespace oraclegs::seva
