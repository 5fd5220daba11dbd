#pragma once
// What training minimises in a picture: the paper's two losses, of photographs and of proposals
// (docs/method.md#losses).

#include <functional>

#include "oraclegs/core/buffer.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/render/image_buffer.h"

namespace oraclegs {

/// LPIPS(render, target) of two pictures [H,W,3] in [0,1]. Adds weight * dLPIPS/d(render) to grad [H,W,3]; undefined =
/// value only.
using PerceptualDistance =
    std::function<double(const Buffer<float>& render, const Buffer<float>& target, double weight, Buffer<float>* grad)>;

struct ObjectiveWeights {
  double photograph_ssim = 0.2;  ///< share of 1-SSIM in a photograph's loss, the rest is L1
  double proposal_ssim = 0.3;    ///< lambda': share of 1-SSIM in a proposal's
  double proposal_lpips = 0.3;   ///< share of LPIPS in it; L1 gets it where there is no network, and the rest
  double proposal = 1;           ///< factor of a proposal's whole loss
};

/// Photographs: (1 - s) mean|I^ - I| + s (1 - SSIM).
/// Proposals: w ((1 - l' - l) mean(|I^ - I| U) + l' mean((1 - SSIM) U) + l mean(U) LPIPS(I^, I)), U the confidence.
/// All means run over all pixels, also over those that count nothing. Owns its buffers, which grow to the largest
/// picture and are then reused. The same bits for any number of threads.
class Objective {
 public:
  /// An empty `lpips` stands for no network. Throws UsageError when a proposal's shares sum to more than 1.
  explicit Objective(const ObjectiveWeights& weights, PerceptualDistance lpips = {});

  /// render, target [H,W,3]; mask [H,W], undefined = 1 everywhere. Where the mask is zero nothing that stands in either
  /// picture has a say, not through SSIM's windows either. grad [H,W,3] receives dL/d(render). Throws ShapeError.
  double Photograph(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask,
                    Buffer<float>* grad);

  /// The same with confidence U [H,W] in [0,1], undefined = 1 everywhere. It weighs each pixel's terms; windows of
  /// pixels that count see the proposal as it is.
  double Proposal(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& confidence,
                  Buffer<float>* grad);

  bool has_lpips() const { return static_cast<bool>(lpips_); }

  // What the losses are made of, for devices that work them out themselves.
  PhotometricWeights PhotographWeights() const;
  PhotometricWeights ProposalWeights() const;
  /// Of a proposal of this mean confidence; 0 without a network.
  double LpipsWeight(double mean_confidence) const;
  const PerceptualDistance& lpips() const { return lpips_; }

 private:
  ObjectiveWeights weights_;
  PerceptualDistance lpips_;
  PhotometricLoss photometric_;
  ImageBuffer masked_;
};

/// Mean over the pixels; 1 where it is undefined, which stands for 1 everywhere.
double MeanConfidence(const Buffer<float>& confidence);

}  // namespace oraclegs
