#pragma once
// Multi-view transformer of SEVA's UNet (docs/method.md#seva-multi-view-transformer): attention within frames or over
// all frames of a sequence, then attention over the frames at one pixel. There is no positional encoding: only the
// cameras tell frames apart.

#include <vector>

#include "oraclegs/networks/seva/norms.h"
#include "oraclegs/networks/seva/sums.h"

namespace oraclegs::seva {

/// Feed-forward layer of SEVA's transformers: half of the first product's outputs gates the other half.
struct FeedForward {
  Linear in, out;
};
/// The hidden layer has 4 x `channels`.
FeedForward LoadFeedForward(const ParameterScope& at, int64_t channels);
/// x [..., channels] -> rows of the same shape: out(a * GELU(g)) with in(x) = (a, g), some tokens at a time. The bias
/// of `out` may be apart, as in AddendOf.
Addend Forward(const FeedForward& layer, const Tensor& x);

struct Attention {
  Linear q, k, v;  ///< without bias
  Linear out;
  int64_t heads = 0;
};

struct TokenBlock {
  LayerNorm norm1, norm2, norm3;
  Attention self, cross;
  FeedForward feed_forward;
};

struct TimeBlock {
  LayerNorm norm_in;
  FeedForward feed_forward_in;
  TokenBlock tokens;
};

/// Tokens of a sequence that attend to each other in the spatial blocks.
enum class Reach { kFrame, kSequence };

struct MultiView {
  GroupNorm norm;
  Linear proj_in, proj_out;
  std::vector<TokenBlock> spatial;
  std::vector<TimeBlock> time;  ///< one for each spatial block
  Reach reach = Reach::kFrame;
  size_t index = 0;  ///< index among the multi-view transformers of a network; position of its context
};

struct MultiViewShape {
  int64_t channels = 0, head_width = 64, depth = 1, context = 1024, groups = 32;
  Reach reach = Reach::kFrame;
};
/// Throws ShapeError when the head width does not divide the channels.
MultiView LoadMultiView(const ParameterScope& at, const MultiViewShape& shape);

/// Inputs of cross attention, which do not change from step to step.
struct Cross {
  Tensor update;           ///< [G, 1, C], with one context token: added to every token; else undefined
  Tensor update_and_bias;  ///< update plus the bias of self attention's output layer, which comes just before
  Tensor k, v;             ///< [G, heads, L, head width], with several context tokens
};
struct MultiViewContext {
  std::vector<Cross> spatial, time;  ///< one entry a block
};
/// context [N, L, width], `frames` adjacent rows a sequence. Where tokens of different frames attend to each other, a
/// sequence has the context of its first frame.
MultiViewContext PrepareContext(const MultiView& block, const Tensor& context, int64_t frames);

/// x [N, C, h, w], `frames` adjacent rows a sequence -> [N, C, h, w].
Tensor Forward(const MultiView& block, const Tensor& x, const MultiViewContext& context, int64_t frames);

}  // namespace oraclegs::seva
