#include "oraclegs/train/loss_terms.h"

#include <cmath>
#include <utility>

#include "oraclegs/train/exposure.h"
#include "oraclegs/train/schedule.h"

namespace oraclegs {
namespace {

constexpr double kRounding = 1e-9;  // of a sum of shares that is 1 on paper

std::vector<TrainView> CleanPhotos(std::vector<TrainView> views) {
  CheckViews(views);
  for (TrainView& view : views) view = WithCleanDepth(std::move(view));
  return views;
}

/// The proposals with the confidence that weighs their pixels, and clean depth. LPIPS knows an image by its buffer.
std::vector<TrainView> CleanProposals(std::vector<TrainView> views, const TrainOptions& options, bool has_lpips) {
  CheckProposals(views);
  for (TrainView& view : views) {
    if (has_lpips) view.image = view.Image(), view.image_bytes = {};
    view = WithCleanDepth(WithConfidencePower(std::move(view), options.confidence_power));
  }
  return views;
}

std::vector<double> MeanConfidences(const std::vector<TrainView>& views) {
  std::vector<double> means;
  for (const TrainView& view : views) means.push_back(MeanConfidence(view));
  return means;
}

/// Characteristic depth of the photos; that of the proposals where no photo has depth.
double SceneDepth(const std::vector<TrainView>& photos, const std::vector<TrainView>& proposals) {
  const double depth = CharacteristicDepth(photos);
  return depth > 0 ? depth : CharacteristicDepth(proposals);
}

void CheckShares(const TrainOptions& options) {
  const double shares = options.proposal_ssim + options.proposal_lpips;
  if (!(shares <= 1 + kRounding)) {
    throw UsageError("--set proposal-ssim={} and --set proposal-lpips={} sum to {}, must leave L1 0 or more of 1",
                     options.proposal_ssim, options.proposal_lpips, shares);
  }
}

ViewPlane WeightsOf(const TrainView& view) { return view.HasWeights() ? ViewPlane::kPixelWeight : ViewPlane::kNone; }

}  // namespace

LossPlan::LossPlan(const TrainOptions& options, TrainingData data)
    : options_(options),
      photos_(CleanPhotos(std::move(data.photos))),
      proposals_(CleanProposals(std::move(data.proposals), options, static_cast<bool>(data.lpips))),
      mean_confidence_(MeanConfidences(proposals_)),
      lpips_(std::move(data.lpips)),
      depth_scale_(options.depth_weight *
                   (options.depth_loss == DepthLoss::kPaper ? 1 : SceneDepth(photos_, proposals_))) {
  CheckShares(options);
}

const TrainView& LossPlan::View(const SampledView& sampled) const {
  return Views(sampled.kind)[static_cast<size_t>(sampled.index)];
}

std::vector<ExposureMap> LossPlan::StartExposures() const {
  std::vector<ExposureMap> maps;
  if (options_.exposure != ExposureMode::kOn) return maps;
  for (const TrainView& view : photos_) maps.push_back(view.exposure);
  return maps;
}

LossTerm LossPlan::PhotometricTerm(ViewKind kind, const TrainView& view) const {
  LossTerm term{TermKind::kPhotometric, 1, ViewPlane::kImage, WeightsOf(view)};
  if (kind == ViewKind::kPhoto) {
    term.photometric = {static_cast<float>(1 - options_.ssim_weight), static_cast<float>(options_.ssim_weight)};
    term.mask_meaning = MaskMeaning::kMask;
  } else {
    const double l1 = 1 - options_.proposal_ssim - (lpips_ ? options_.proposal_lpips : 0);
    term.photometric = {static_cast<float>(l1), static_cast<float>(options_.proposal_ssim)};
  }
  return term;
}

LossTerms LossPlan::Terms(const SampledView& sampled, int64_t iteration) const {
  const TrainView& view = View(sampled);
  const bool is_proposal = sampled.kind == ViewKind::kProposal;
  LossTerms terms;
  terms.Add(PhotometricTerm(sampled.kind, view));
  if (!is_proposal && options_.exposure == ExposureMode::kOn) {
    terms.Add({TermKind::kExposure, kExposureRegularizer});
    terms.exposure = sampled.index;
    const bool is_last = iteration >= options_.iterations;
    terms.exposure_rate = is_last ? 0 : ExposureLearningRate(iteration, options_.Horizon());
  }
  if (is_proposal && lpips_) {
    const double confidence = mean_confidence_[static_cast<size_t>(sampled.index)];
    const double weight = options_.proposal_lpips * confidence;
    // The network takes most of the time: skipped at weight 0.
    if (weight != 0) terms.Add({TermKind::kPerceptual, weight, ViewPlane::kImage});
  }
  const double depth_weight = depth_scale_ * DepthWeight(iteration, options_.Horizon());
  if (depth_weight != 0 && view.inv_depth.defined()) {
    terms.Add({TermKind::kInvDepth, depth_weight, ViewPlane::kInvDepth, ViewPlane::kDepthMask});
  }
  if (options_.alpha_weight != 0 && view.alpha.defined()) {
    terms.Add({TermKind::kAlpha, options_.alpha_weight, ViewPlane::kAlpha, WeightsOf(view)});
  }
  return terms;
}

void RequireFinite(double loss, int64_t iteration, const TrainView& view) {
  if (std::isfinite(loss)) return;
  throw Diverged(
      "the loss is {} at iteration {} on {}: training has diverged; check the poses and the scale of the scene", loss,
      iteration, view.name);
}

}  // namespace oraclegs
