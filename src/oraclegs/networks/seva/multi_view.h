#pragma once
// The multi-view transformer of SEVA's UNet (docs/method.md#seva-multi-view-transformer): attention within frames or
// over all frames of a sequence, then attention over the frames at one pixel. There is no positional encoding: cameras
// alone tell frames apart.

#include <vector>

#include "oraclegs/networks/seva/group_norm.h"

namespace oraclegs {

struct SevaAttention {
  Linear q, k, v;  ///< without bias
  Linear out;
  int64_t heads = 0;
};

/// Two linear layers; half of what the first gives gates the other half: a * GELU(g).
struct SevaFeedForward {
  Linear in, out;
};

struct SevaTokenBlock {
  LayerNorm norm1, norm2, norm3;
  SevaAttention self, cross;
  SevaFeedForward feed_forward;
};

struct SevaTimeBlock {
  LayerNorm norm_in;
  SevaFeedForward feed_forward_in;
  SevaTokenBlock tokens;
};

/// Which tokens of a sequence the spatial blocks let look at each other.
enum class SevaReach { kFrame, kSequence };

struct SevaMultiView {
  GroupNorm norm;
  Linear proj_in, proj_out;
  std::vector<SevaTokenBlock> spatial;
  std::vector<SevaTimeBlock> time;  ///< as many
  SevaReach reach = SevaReach::kFrame;
  size_t index = 0;  ///< among the multi-view transformers of a network; where its context stands
};

struct SevaMultiViewShape {
  int64_t channels = 0, head_width = 64, depth = 1, context = 1024, groups = 32;
  SevaReach reach = SevaReach::kFrame;
};
/// Throws ShapeError when the head width does not divide the channels.
SevaMultiView LoadSevaMultiView(const ParameterScope& at, const SevaMultiViewShape& shape);

/// What cross attention takes from the context, which does not change from step to step.
struct SevaCross {
  Tensor update;  ///< [G, 1, C], with one context token: what is added to every token; else undefined
  Tensor k, v;    ///< [G, heads, L, head width], with several
};
struct SevaMultiViewContext {
  std::vector<SevaCross> spatial, time;  ///< of each block
};
/// context [N, L, width], `frames` adjacent rows a sequence. Where tokens of different frames meet, a sequence has the
/// context of its first frame.
SevaMultiViewContext PrepareContext(const SevaMultiView& block, const Tensor& context, int64_t frames);

/// x [N, C, h, w], `frames` adjacent rows a sequence -> [N, C, h, w].
Tensor Forward(const SevaMultiView& block, const Tensor& x, const SevaMultiViewContext& context, int64_t frames);

}  // namespace oraclegs
