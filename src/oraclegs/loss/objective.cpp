#include "oraclegs/loss/objective.h"

#include <utility>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr double kRounding = 1e-9;  // of a sum of shares that is 1 on paper

/// out = where(mask > 0, inside, outside), pixel by pixel; `outside` undefined is zero. Images are [H,W,3].
void SelectByMask(const Tensor& mask, const Tensor& inside, const Tensor& outside, const Tensor& out) {
  const float* m = mask.data_ptr<float>();
  const float* a = inside.data_ptr<float>();
  const float* b = outside.defined() ? outside.data_ptr<float>() : nullptr;
  float* o = out.data_ptr<float>();
  ParallelBlocks(mask.numel(), 1 << 14, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      for (int64_t c = 3 * i; c < 3 * i + 3; ++c) o[c] = m[i] > 0 ? a[c] : (b ? b[c] : 0.f);
    }
  });
}

}  // namespace

Objective::Objective(const ObjectiveWeights& weights, PerceptualDistance lpips)
    : weights_(weights), lpips_(std::move(lpips)) {
  const double shares = weights.proposal_ssim + weights.proposal_lpips;
  if (!(shares <= 1 + kRounding)) {
    throw UsageError("--proposal-ssim {} and --proposal-lpips {} sum to {}, must leave L1 0 or more of 1",
                     weights.proposal_ssim, weights.proposal_lpips, shares);
  }
}

PhotometricWeights Objective::PhotographWeights() const {
  return {static_cast<float>(1 - weights_.photograph_ssim), static_cast<float>(weights_.photograph_ssim)};
}

PhotometricWeights Objective::ProposalWeights() const {
  const double l1 = 1 - weights_.proposal_ssim - (lpips_ ? weights_.proposal_lpips : 0);
  return {static_cast<float>(weights_.proposal * l1), static_cast<float>(weights_.proposal * weights_.proposal_ssim)};
}

double Objective::LpipsWeight(double mean_confidence) const {
  return lpips_ ? weights_.proposal * weights_.proposal_lpips * mean_confidence : 0;
}

double Objective::Photograph(const Tensor& render, const Tensor& target, const Tensor& mask, Tensor* grad) {
  const PhotometricWeights weights = PhotographWeights();
  if (!mask.defined()) return photometric_(render, target, {}, weights, grad).loss;
  RequireFloat("Objective", "render", render, {-1, -1, 3});
  RequireFloat("Objective", "target", target, {render.size(0), render.size(1), 3});
  RequireFloat("Objective", "mask", mask, {render.size(0), render.size(1)});
  // SSIM looks 5 pixels around: where the mask is zero the render is replaced by the photograph, so that what stands
  // there says nothing about the pixels that count, and takes no gradient from them.
  const Tensor masked = masked_.Get({render.size(0), render.size(1), 3});
  SelectByMask(mask, render, target, masked);
  const double value = photometric_(masked, target, mask, weights, grad).loss;
  if (grad != nullptr && grad->defined()) SelectByMask(mask, *grad, {}, *grad);
  return value;
}

double Objective::Proposal(const Tensor& render, const Tensor& target, const Tensor& confidence, Tensor* grad) {
  const double value = photometric_(render, target, confidence, ProposalWeights(), grad).loss;
  if (!lpips_) return value;
  const double weight = LpipsWeight(MeanConfidence(confidence));
  if (weight == 0) return value;  // the network is what takes the time
  return value + weight * lpips_(render, target, weight, grad);
}

double MeanConfidence(const Tensor& confidence) {
  if (!confidence.defined()) return 1;
  const float* u = confidence.data_ptr<float>();
  double sum = 0;
  for (int64_t i = 0; i < confidence.numel(); ++i) sum += static_cast<double>(u[i]);
  return sum / static_cast<double>(confidence.numel());
}

}  // namespace oraclegs
