#include "oraclegs/networks/seva/multi_view.h"

#include "oraclegs/networks/common/attention.h"
#include "oraclegs/networks/seva/slices.h"

namespace oraclegs::seva {
namespace {

constexpr int64_t kFeedForwardRatio = 4;

Linear LoadWithoutBias(const ParameterScope& at, int64_t in, int64_t out) { return {at.Get("weight", {out, in}), {}}; }

Attention LoadAttention(const ParameterScope& at, const MultiViewShape& shape, int64_t context) {
  const int64_t channels = shape.channels;
  return {LoadWithoutBias(at / "to_q", channels, channels), LoadWithoutBias(at / "to_k", context, channels),
          LoadWithoutBias(at / "to_v", context, channels), LoadLinear(at / "to_out" / 0, channels, channels),
          channels / shape.head_width};
}

FeedForward LoadFeedForward(const ParameterScope& at, int64_t channels) {
  const int64_t hidden = kFeedForwardRatio * channels;
  return {LoadLinear(at / "net" / 0 / "proj", channels, 2 * hidden), LoadLinear(at / "net" / 2, hidden, channels)};
}

TokenBlock LoadTokenBlock(const ParameterScope& at, const MultiViewShape& shape) {
  TokenBlock block;
  block.norm1 = LoadLayerNorm(at / "norm1", shape.channels, 1e-5);
  block.norm2 = LoadLayerNorm(at / "norm2", shape.channels, 1e-5);
  block.norm3 = LoadLayerNorm(at / "norm3", shape.channels, 1e-5);
  block.self = LoadAttention(at / "attn1", shape, shape.channels);
  block.cross = LoadAttention(at / "attn2", shape, shape.context);
  block.feed_forward = LoadFeedForward(at / "ff", shape.channels);
  return block;
}

/// x [G, tokens, C] -> [G, heads, tokens, C / heads]
Tensor Heads(const Tensor& x, int64_t heads) {
  return x.view({x.size(0), x.size(1), heads, x.size(2) / heads}).transpose(1, 2);
}

/// The reverse, then the output layer.
Tensor Join(const Attention& layer, const Tensor& attended) {
  return Forward(layer.out, attended.transpose(1, 2).flatten(2));
}

/// The layer of some of the outputs.
Linear Outputs(const Linear& layer, int64_t begin, int64_t end) {
  return {layer.weight.slice(0, begin, end), layer.bias.slice(0, begin, end)};
}

/// into += feed-forward(norm(from)), some tokens at a time; `from` may be `into`. Values and gates come from two
/// products, since halves of one are strided, which a GPU reads at half the rate.
void AddFeedForward(const FeedForward& layer, const LayerNorm& norm, const Tensor& from, Tensor* into) {
  const int64_t channels = from.size(-1), hidden = kFeedForwardRatio * channels;
  const Linear values = Outputs(layer.in, 0, hidden), gates = Outputs(layer.in, hidden, 2 * hidden);
  const Tensor tokens = from.view({-1, channels});
  Tensor sums = into->view({-1, channels});
  const int64_t step = RowsAtOnce(from, 2 * hidden), count = tokens.size(0);
  for (int64_t begin = 0; begin < count; begin += step) {
    const int64_t end = std::min(begin + step, count);
    const Tensor x = Forward(norm, tokens.slice(0, begin, end));
    Tensor gated = Forward(gates, x);
    at::gelu_(gated);
    gated.mul_(Forward(values, x));
    sums.slice(0, begin, end).add_(Forward(layer.out, gated));
  }
}

void AddCross(const TokenBlock& block, const Cross& cross, Tensor* y) {
  if (cross.update.defined()) {
    y->add_(cross.update);
    return;
  }
  const Tensor q = Heads(Forward(block.cross.q, Forward(block.norm2, *y)), block.cross.heads);
  y->add_(Join(block.cross, Attend(q, cross.k, cross.v)));
}

/// y [G, tokens, C], attention within each of the G.
void ApplySpatial(const TokenBlock& block, const Cross& cross, Tensor* y) {
  {
    const Tensor x = Forward(block.norm1, *y);
    const int64_t heads = block.self.heads;
    y->add_(Join(block.self, Attend(Heads(Forward(block.self.q, x), heads), Heads(Forward(block.self.k, x), heads),
                                    Heads(Forward(block.self.v, x), heads))));
  }
  AddCross(block, cross, y);
  AddFeedForward(block.feed_forward, block.norm3, *y, y);
}

/// x [B, T, S, C] -> [B S, heads, T, C / heads]: the frames at one pixel.
Tensor PixelHeads(const Tensor& x, int64_t heads) {
  const Tensor split = x.view({x.size(0), x.size(1), x.size(2), heads, x.size(3) / heads});
  return split.permute({0, 2, 3, 1, 4}).flatten(0, 1);
}

/// s [B, T, S, C] += time-mix block of s. All but its self attention is token by token, so nothing else is regrouped.
void AddTimeMix(const TimeBlock& block, const Cross& cross, Tensor* s) {
  const int64_t batch = s->size(0), frames = s->size(1), pixels = s->size(2), channels = s->size(3);
  const TokenBlock& rest = block.tokens;
  Tensor v = s->clone();
  AddFeedForward(block.feed_forward_in, block.norm_in, *s, &v);
  {
    const Tensor x = Forward(rest.norm1, v);
    const int64_t heads = rest.self.heads;
    const Tensor attended =
        Attend(PixelHeads(Forward(rest.self.q, x), heads), PixelHeads(Forward(rest.self.k, x), heads),
               PixelHeads(Forward(rest.self.v, x), heads));
    const Tensor back = attended.view({batch, pixels, heads, frames, channels / heads}).permute({0, 3, 1, 2, 4});
    v.add_(Forward(rest.self.out, back.flatten(3)));
  }
  Tensor sequences = v.view({batch, frames * pixels, channels});  // one context a sequence
  AddCross(rest, cross, &sequences);
  AddFeedForward(rest.feed_forward, rest.norm3, v, s);  // the last one has no residual of v
}

Cross PrepareCross(const Attention& layer, const Tensor& context) {
  const Tensor v = Forward(layer.v, context);
  if (context.size(1) == 1) return {Forward(layer.out, v), {}, {}};  // the softmax over one token is 1
  return {{}, Heads(Forward(layer.k, context), layer.heads), Heads(v, layer.heads)};
}

}  // namespace

MultiView LoadMultiView(const ParameterScope& at, const MultiViewShape& shape) {
  if (shape.head_width <= 0 || shape.channels % shape.head_width != 0) {
    throw ShapeError("LoadMultiView: heads of {} do not divide {} channels", shape.head_width, shape.channels);
  }
  MultiView block;
  block.reach = shape.reach;
  block.norm = LoadGroupNorm(at / "norm", shape.channels, shape.groups, 1e-6);
  block.proj_in = LoadLinear(at / "proj_in", shape.channels, shape.channels);
  for (int64_t i = 0; i < shape.depth; ++i) {
    block.spatial.push_back(LoadTokenBlock(at / "transformer_blocks" / i, shape));
    const ParameterScope mix = at / "time_mix_blocks" / i;
    block.time.push_back({LoadLayerNorm(mix / "norm_in", shape.channels, 1e-5),
                          LoadFeedForward(mix / "ff_in", shape.channels), LoadTokenBlock(mix, shape)});
  }
  block.proj_out = LoadLinear(at / "proj_out", shape.channels, shape.channels);
  return block;
}

MultiViewContext PrepareContext(const MultiView& block, const Tensor& context, int64_t frames) {
  const Tensor first = context.slice(0, 0, context.size(0), frames);
  MultiViewContext prepared;
  for (size_t i = 0; i < block.spatial.size(); ++i) {
    const bool sequence = block.reach == Reach::kSequence;
    prepared.spatial.push_back(PrepareCross(block.spatial[i].cross, sequence ? first : context));
    prepared.time.push_back(PrepareCross(block.time[i].tokens.cross, first));
  }
  return prepared;
}

Tensor Forward(const MultiView& block, const Tensor& x, const MultiViewContext& context, int64_t frames) {
  const int64_t rows = x.size(0), channels = x.size(1), pixels = x.size(2) * x.size(3), batch = rows / frames;
  Tensor z = Forward(block.proj_in, Forward(block.norm, x).flatten(2).transpose(1, 2).contiguous());
  for (size_t i = 0; i < block.spatial.size(); ++i) {
    const bool sequence = block.reach == Reach::kSequence;
    Tensor groups = sequence ? z.view({batch, frames * pixels, channels}) : z;
    ApplySpatial(block.spatial[i], context.spatial[i], &groups);
    Tensor by_frame = z.view({batch, frames, pixels, channels});
    AddTimeMix(block.time[i], context.time[i], &by_frame);
  }
  return x + Forward(block.proj_out, z).transpose(1, 2).reshape(x.sizes());
}

}  // namespace oraclegs::seva
