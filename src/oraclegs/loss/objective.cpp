#include "oraclegs/loss/objective.h"

#include <utility>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr double kRounding = 1e-9;  // of a sum of shares that is 1 on paper

/// out = where(mask > 0, inside, outside), pixel by pixel; `outside` undefined is zero. Images are [H,W,3].
void SelectByMask(const Buffer<float>& mask, const Buffer<float>& inside, const Buffer<float>& outside,
                  const Buffer<float>& out) {
  const float* m = mask.data();
  const float* a = inside.data();
  const float* b = outside.defined() ? outside.data() : nullptr;
  float* o = out.data();
  ParallelBlocks(mask.count(), 1 << 14, [&](int64_t begin, int64_t end) {
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

double Objective::Photograph(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& mask,
                             Buffer<float>* grad) {
  const PhotometricWeights weights = PhotographWeights();
  if (!mask.defined()) return photometric_(render, target, {}, weights, grad).loss;
  RequireShape("Objective", "render", render, {-1, -1, 3});
  RequireShape("Objective", "target", target, {render.size(0), render.size(1), 3});
  RequireShape("Objective", "mask", mask, {render.size(0), render.size(1)});
  // SSIM looks 5 pixels around: where the mask is zero the render is replaced by the photograph, so that what stands
  // there says nothing about the pixels that count, and takes no gradient from them.
  const Buffer<float> masked = masked_.Get({render.size(0), render.size(1), 3});
  SelectByMask(mask, render, target, masked);
  const double value = photometric_(masked, target, mask, weights, grad).loss;
  if (grad != nullptr && grad->defined()) SelectByMask(mask, *grad, {}, *grad);
  return value;
}

double Objective::Proposal(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& confidence,
                           Buffer<float>* grad) {
  const double value = photometric_(render, target, confidence, ProposalWeights(), grad).loss;
  if (!lpips_) return value;
  const double weight = LpipsWeight(MeanConfidence(confidence));
  if (weight == 0) return value;  // the network is what takes the time
  return value + weight * lpips_(render, target, weight, grad);
}

double MeanConfidence(const Buffer<float>& confidence) {
  if (!confidence.defined()) return 1;
  const float* u = confidence.data();
  double sum = 0;
  for (int64_t i = 0; i < confidence.count(); ++i) sum += static_cast<double>(u[i]);
  return sum / static_cast<double>(confidence.count());
}

}  // namespace oraclegs
