#pragma once
// Operations of a step of SEVA, so that a measured time can be compared with the machine's peak
// (docs/method.md#seva-cost-and-memory).

#include "oraclegs/networks/seva/unet.h"

namespace oraclegs::seva {

inline constexpr double kMultiplyAdd = 2;

/// Operations (a multiply-add is two) of one evaluation of both halves of guidance: linear layers, convolutions and
/// attention as the published network has them. (With one context token we skip a few per cent of it.)
struct Cost {
  double total = 0;
  double joint_attention = 0;  ///< share of the total: scores and values where all frames attend to each other
};
/// Counts operations along the network.
class CostCounter {
 public:
  CostCounter(int64_t frames, int64_t height, int64_t width) : frames_(frames), pixels_(height * width) {}

  const Cost& cost() const { return cost_; }

  /// Adds a linear layer on `tokens`, or a convolution that gives so many pixels.
  void Weight(const Tensor& weight, int64_t tokens) {
    cost_.total += kMultiplyAdd * static_cast<double>(weight.numel()) * static_cast<double>(tokens);
  }

  void AddBlock(const UnetBlock& block) {
    for (const UnetLayer& layer : block) std::visit([this](const auto& l) { Add(l); }, layer);
  }

  int64_t Rows() const { return 2 * frames_; }
  int64_t Tokens() const { return Rows() * pixels_; }

 private:
  void Add(const Conv& conv) {
    pixels_ /= conv.stride * conv.stride;
    Weight(conv.weight, Tokens());
  }
  void Add(const Up& up) {
    pixels_ *= 4;
    Weight(up.conv.weight, Tokens());
  }
  void Add(const ResBlock& block) {
    for (const Conv* conv : {&block.dense, &block.conv_in, &block.conv_out}) Weight(conv->weight, Tokens());
    if (block.skip) Weight(block.skip->weight, Tokens());
    Weight(block.embedding.weight, Rows());
  }
  void Add(const MultiView& block) {
    Weight(block.proj_in.weight, Tokens());
    Weight(block.proj_out.weight, Tokens());
    const bool joint = block.reach == Reach::kSequence;
    for (const TokenBlock& spatial : block.spatial) {
      const double scores = AddTokenBlock(spatial, joint ? frames_ * pixels_ : pixels_, joint ? 2 : Rows());
      if (joint) cost_.joint_attention += scores;
    }
    for (const TimeBlock& time : block.time) {
      AddFeedForward(time.feed_forward_in);
      AddTokenBlock(time.tokens, frames_, 2 * pixels_);
    }
  }

  void AddFeedForward(const FeedForward& layer) {
    Weight(layer.in.weight, Tokens());
    Weight(layer.out.weight, Tokens());
  }

  /// Adds a block in which each token attends to `keys` tokens and to one of `contexts`; returns the cost of the
  /// former.
  double AddTokenBlock(const TokenBlock& block, int64_t keys, int64_t contexts) {
    for (const Linear* linear : {&block.self.q, &block.self.k, &block.self.v, &block.self.out}) {
      Weight(linear->weight, Tokens());
    }
    const double one_key =
        2 * kMultiplyAdd * static_cast<double>(block.self.out.weight.size(0)) * static_cast<double>(Tokens());
    const double scores = one_key * static_cast<double>(keys);
    Weight(block.cross.q.weight, Tokens());
    Weight(block.cross.out.weight, Tokens());
    Weight(block.cross.k.weight, contexts);
    Weight(block.cross.v.weight, contexts);
    cost_.total += scores + one_key;
    AddFeedForward(block.feed_forward);
    return scores;
  }

  int64_t frames_, pixels_;
  Cost cost_;
};

/// `unet` may have no memory (ListedParameters); latents of `height` x `width`.
inline Cost CostOfStep(const Unet& unet, int64_t frames, int64_t height, int64_t width) {
  CostCounter counter(frames, height, width);
  counter.Weight(unet.time1.weight, counter.Rows());
  counter.Weight(unet.time2.weight, counter.Rows());
  for (const UnetBlock& block : unet.input_blocks) counter.AddBlock(block);
  counter.AddBlock(unet.middle);
  for (const UnetBlock& block : unet.output_blocks) counter.AddBlock(block);
  counter.Weight(unet.conv_out.weight, counter.Tokens());
  return counter.cost();
}

}  // namespace oraclegs::seva
