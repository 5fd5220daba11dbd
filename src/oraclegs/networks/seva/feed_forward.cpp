#include "oraclegs/networks/seva/feed_forward.h"

#include "oraclegs/networks/seva/kernels.h"
#include "oraclegs/networks/seva/slices.h"

namespace oraclegs::seva {
namespace {

constexpr int64_t kRatio = 4;

/// Layer that computes outputs begin to end - 1 alone.
Linear Outputs(const Linear& layer, int64_t begin, int64_t end) {
  return {layer.weight.slice(0, begin, end), layer.bias.slice(0, begin, end)};
}

/// a * GELU(g). libtorch computes values and gates in two products: the halves of one product are strided, which a GPU
/// reads at half the rate.
Tensor Gated(const Linear& layer, const Tensor& x) {
  const int64_t hidden = layer.weight.size(0) / 2;
  if (kernels::CanTake(x)) {
    if (Tensor gated = kernels::GatedGelu(Forward(layer, x)); gated.defined()) return gated;
  }
  Tensor gated = Forward(Outputs(layer, hidden, 2 * hidden), x);
  at::gelu_(gated);
  return gated.mul_(Forward(Outputs(layer, 0, hidden), x));
}

}  // namespace

FeedForward LoadFeedForward(const ParameterScope& at, int64_t channels) {
  const int64_t hidden = kRatio * channels;
  return {LoadLinear(at / "net" / 0 / "proj", channels, 2 * hidden), LoadLinear(at / "net" / 2, hidden, channels)};
}

Addend Forward(const FeedForward& layer, const Tensor& x) {
  const Tensor tokens = x.reshape({-1, x.size(-1)}), &weight = layer.out.weight;
  const int64_t step = RowsAtOnce(x, layer.in.weight.size(0)), count = tokens.size(0);
  Tensor out;
  for (int64_t begin = 0; begin < count; begin += step) {
    const int64_t end = std::min(begin + step, count);
    const Tensor gated = Gated(layer.in, tokens.slice(0, begin, end));
    if (!out.defined()) out = at::empty(tokens.sizes(), gated.options());
    Tensor part = out.slice(0, begin, end);
    if (kernels::CanTake(gated)) {
      at::mm_out(part, gated, weight.t());
    } else if (gated.scalar_type() == weight.scalar_type()) {
      at::addmm_out(part, layer.out.bias, gated, weight.t());
    } else {
      part.copy_(Forward(layer.out, gated));  // type differs within Autocast
    }
  }
  return {out.view(x.sizes()), kernels::CanTake(out) ? layer.out.bias : Tensor()};
}

}  // namespace oraclegs::seva
