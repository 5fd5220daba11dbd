#include "oraclegs/networks/seva/cost.h"

namespace oraclegs {
namespace {

constexpr double kMultiplyAdd = 2;

/// Walks the network and counts.
class Counter {
 public:
  Counter(int64_t frames, int64_t height, int64_t width) : frames_(frames), pixels_(height * width) {}

  const SevaCost& cost() const { return cost_; }

  /// A linear layer on `tokens`, or a convolution that gives so many pixels.
  void Weight(const Tensor& weight, int64_t tokens) {
    cost_.total += kMultiplyAdd * static_cast<double>(weight.numel()) * static_cast<double>(tokens);
  }

  void Block(const SevaBlock& block) {
    for (const SevaLayer& layer : block) std::visit([this](const auto& l) { Add(l); }, layer);
  }

  int64_t Rows() const { return 2 * frames_; }
  int64_t Tokens() const { return Rows() * pixels_; }

 private:
  void Add(const Conv& conv) {
    pixels_ /= conv.stride * conv.stride;
    Weight(conv.weight, Tokens());
  }
  void Add(const SevaUp& up) {
    pixels_ *= 4;
    Weight(up.conv.weight, Tokens());
  }
  void Add(const SevaResBlock& block) {
    for (const Conv* conv : {&block.dense, &block.conv_in, &block.conv_out}) Weight(conv->weight, Tokens());
    if (block.skip) Weight(block.skip->weight, Tokens());
    Weight(block.embedding.weight, Rows());
  }
  void Add(const SevaMultiView& block) {
    Weight(block.proj_in.weight, Tokens());
    Weight(block.proj_out.weight, Tokens());
    const bool joint = block.reach == SevaReach::kSequence;
    for (const SevaTokenBlock& spatial : block.spatial) {
      const double scores = TokenBlock(spatial, joint ? frames_ * pixels_ : pixels_, joint ? 2 : Rows());
      if (joint) cost_.joint_attention += scores;
    }
    for (const SevaTimeBlock& time : block.time) {
      FeedForward(time.feed_forward_in);
      TokenBlock(time.tokens, frames_, 2 * pixels_);
    }
  }

  void FeedForward(const SevaFeedForward& layer) {
    Weight(layer.in.weight, Tokens());
    Weight(layer.out.weight, Tokens());
  }

  /// Each token looks at `keys` tokens, and at one of `contexts`; the cost of looking at the former.
  double TokenBlock(const SevaTokenBlock& block, int64_t keys, int64_t contexts) {
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
    FeedForward(block.feed_forward);
    return scores;
  }

  int64_t frames_, pixels_;
  SevaCost cost_;
};

}  // namespace

SevaCost CostOfStep(const SevaUnet& unet, int64_t frames, int64_t height, int64_t width) {
  Counter counter(frames, height, width);
  counter.Weight(unet.time1.weight, counter.Rows());
  counter.Weight(unet.time2.weight, counter.Rows());
  for (const SevaBlock& block : unet.input_blocks) counter.Block(block);
  counter.Block(unet.middle);
  for (const SevaBlock& block : unet.output_blocks) counter.Block(block);
  counter.Weight(unet.conv_out.weight, counter.Tokens());
  return counter.cost();
}

}  // namespace oraclegs
