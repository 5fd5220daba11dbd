#include "oraclegs/networks/seva/multi_view.h"

#include "oraclegs/networks/common/attention.h"
#include "oraclegs/networks/seva/kernels.h"
#include "oraclegs/networks/seva/slices.h"
#include "oraclegs/networks/seva/sums.h"

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

Linear LoadWithoutBias(const ParameterScope& at, int64_t in, int64_t out) { return {at.Get("weight", {out, in}), {}}; }

Attention LoadAttention(const ParameterScope& at, const MultiViewShape& shape, int64_t context) {
  const int64_t channels = shape.channels;
  return {LoadWithoutBias(at / "to_q", channels, channels), LoadWithoutBias(at / "to_k", context, channels),
          LoadWithoutBias(at / "to_v", context, channels), LoadLinear(at / "to_out" / 0, channels, channels),
          channels / shape.head_width};
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
Tensor Heads(const Tensor& x, int64_t heads) { return x.unflatten(2, {heads, x.size(2) / heads}).transpose(1, 2); }

/// Inverse of Heads.
Tensor JoinHeads(const Tensor& x) { return x.transpose(1, 2).flatten(2); }

/// Adds self attention and cross attention to y [G, tokens, C]. Returns the norm before the feed-forward layer.
Tensor AfterSelfAttention(const TokenBlock& block, const Cross& cross, const Addend& attended, Tensor* y) {
  if (cross.update.defined()) {
    return NormAfterAdding({attended.rows, kernels::CanTake(*y) ? cross.update_and_bias : cross.update}, block.norm3,
                           y);
  }
  const Tensor x = NormAfterAdding(attended, block.norm2, y);
  const Tensor q = Heads(Forward(block.cross.q, x), block.cross.heads);
  return NormAfterAdding(AddendOf(block.cross.out, JoinHeads(Attend(q, cross.k, cross.v))), block.norm3, y);
}

/// x [..., C] -> queries, keys and values [..., C]. Where kernels take x, one product that reads x once gives them side
/// by side in `all` [..., 3 C].
struct Projections {
  Tensor all, q, k, v;
};
Projections Project(const Attention& layer, const Tensor& x) {
  if (!kernels::CanTake(x)) return {{}, Forward(layer.q, x), Forward(layer.k, x), Forward(layer.v, x)};
  const Tensor all = at::linear(x, at::cat({layer.q.weight, layer.k.weight, layer.v.weight}));
  const std::vector<Tensor> parts = all.chunk(3, -1);
  return {all, parts[0], parts[1], parts[2]};
}

/// Attention within each of the G sequences of x [G, tokens, C].
Addend SelfAttention(const Attention& layer, const Tensor& x) {
  const Projections in = Project(layer, x);
  const Tensor attended = Attend(Heads(in.q, layer.heads), Heads(in.k, layer.heads), Heads(in.v, layer.heads));
  return AddendOf(layer.out, JoinHeads(attended));
}

/// x [B, T, S, C] -> [B S, heads, T, C / heads]: the frames at one pixel.
Tensor PixelHeads(const Tensor& x, int64_t heads) {
  return x.unflatten(3, {heads, x.size(3) / heads}).permute({0, 2, 3, 1, 4}).flatten(0, 1);
}

/// Attention over the frames at one pixel of x [B, T, S, C]; keeps the shape.
Addend TimeAttention(const Attention& layer, const Tensor& x) {
  const int64_t heads = layer.heads;
  const Projections in = Project(layer, x);
  Tensor attended;
  if (in.all.defined()) attended = kernels::AttendAcrossFrames(in.all, heads);
  if (!attended.defined()) {
    attended = Attend(PixelHeads(in.q, heads), PixelHeads(in.k, heads), PixelHeads(in.v, heads))
                   .view({x.size(0), x.size(2), heads, x.size(1), x.size(3) / heads})
                   .permute({0, 3, 1, 2, 4})
                   .flatten(3);
  }
  return AddendOf(layer.out, attended);
}

/// Addend of a time-mix block to s [B, T, S, C]; x is norm_in of s. Everything but its self attention works token by
/// token, so nothing else is regrouped.
Addend TimeMix(const TimeBlock& block, const Cross& cross, const Tensor& s, Tensor x) {
  const TokenBlock& rest = block.tokens;
  Tensor v;
  x = NormOfSum(s, Forward(block.feed_forward_in, x), rest.norm1, &v);
  Addend attended = TimeAttention(rest.self, x);
  x = v.view({s.size(0), s.size(1) * s.size(2), s.size(3)});  // one context a sequence
  x = AfterSelfAttention(rest, cross, attended, &x);
  attended = Addend(), v = Tensor();
  return Forward(rest.feed_forward, x);  // the last one has no residual of v
}

Cross PrepareCross(const TokenBlock& block, const Tensor& context) {
  const Attention& layer = block.cross;
  const Tensor v = Forward(layer.v, context);
  if (context.size(1) == 1) {  // the softmax over one token is 1
    const Tensor update = Forward(layer.out, v);
    return {update, update + block.self.out.bias, Tensor(), Tensor()};
  }
  return {Tensor(), Tensor(), Heads(Forward(layer.k, context), layer.heads), Heads(v, layer.heads)};
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
    prepared.spatial.push_back(PrepareCross(block.spatial[i], sequence ? first : context));
    prepared.time.push_back(PrepareCross(block.time[i].tokens, first));
  }
  return prepared;
}

Tensor Forward(const MultiView& block, const Tensor& x, const MultiViewContext& context, int64_t frames) {
  const int64_t rows = x.size(0), channels = x.size(1), pixels = x.size(2) * x.size(3), batch = rows / frames;
  const std::vector<int64_t> by_frame = {batch, frames, pixels, channels}, frames_alone = {rows, pixels, channels};
  const std::vector<int64_t> groups =
      block.reach == Reach::kSequence ? std::vector<int64_t>{batch, frames * pixels, channels} : frames_alone;
  Addend addend = AddendOf(block.proj_in, Forward(block.norm, x).flatten(2).transpose(1, 2).contiguous());
  Tensor z = addend.rows;
  addend.rows = Tensor();
  for (size_t i = 0; i < block.spatial.size(); ++i) {
    const TokenBlock& spatial = block.spatial[i];
    const TimeBlock& time = block.time[i];
    z = z.view(groups);
    Tensor y = NormAfterAdding(addend, spatial.norm1, &z);
    y = AfterSelfAttention(spatial, context.spatial[i], SelfAttention(spatial.self, y), &z);
    y = NormAfterAdding(Forward(spatial.feed_forward, y), time.norm_in, &z);
    addend = TimeMix(time, context.time[i], z.view(by_frame), std::move(y).view(by_frame));
  }
  Add(addend, &z);
  z = z.view(frames_alone);
  if (!block.norm.channels_last) return x + Forward(block.proj_out, z).transpose(1, 2).reshape(x.sizes());
  const Addend update = AddendOf(block.proj_out, z);
  const Tensor map = update.rows.view({rows, x.size(2), x.size(3), channels}).permute({0, 3, 1, 2});
  return SumOfMaps(x, map, update.vectors);
}

}  // namespace oraclegs::seva
