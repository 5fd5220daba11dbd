#include "oraclegs/networks/seva/res_block.h"

#include "oraclegs/networks/seva/kernels.h"
#include "oraclegs/networks/seva/sums.h"

namespace oraclegs::seva {
namespace {

/// Block with our own kernels, where they take its maps.
Tensor ByKernels(const ResBlock& block, const Tensor& x, const Tensor& embedding, const Tensor& dense) {
  const Tensor y = Forward(WithoutBias(block.conv_in), NormThenSilu(block.norm_in, x, {{}, &block.dense, dense}));
  const Tensor offsets = Forward(block.embedding, embedding) + block.conv_in.bias;
  const Tensor z = Forward(WithoutBias(block.conv_out), NormThenSilu(block.norm_out, y, {offsets, nullptr, {}}));
  Tensor bias = block.conv_out.bias, skip = x;
  if (block.skip) {
    bias = bias + block.skip->bias;
    skip = Forward(WithoutBias(*block.skip), x);
  }
  return SumOfMaps(skip, z, bias);
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
  if (block.norm_in.channels_last && kernels::CanTake(x)) return ByKernels(block, x, embedding, dense);
  Tensor y = Forward(block.conv_in, NormThenSilu(block.norm_in, x, {{}, &block.dense, dense}));
  y = Forward(block.conv_out, NormThenSilu(block.norm_out, y, {Forward(block.embedding, embedding), nullptr, {}}));
  return y.add_(block.skip ? Forward(*block.skip, x) : x);
}

}  // namespace oraclegs::seva
