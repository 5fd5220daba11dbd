#pragma once
// The views of a run and the terms of each iteration's loss, for every device: devices only evaluate terms.

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/error.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/train/options.h"
#include "oraclegs/train/train_view.h"
#include "oraclegs/train/view_sampler.h"

namespace oraclegs {

/// LPIPS(render, target) of two images [H,W,3] in [0,1]. Adds weight * dLPIPS/d(render) to grad [H,W,3]; undefined =
/// value only. An empty function stands for no network.
using PerceptualDistance =
    std::function<double(const Buffer<float>& render, const Buffer<float>& target, double weight, Buffer<float>* grad)>;

/// Error of a training whose loss or parameters became NaN or infinite. Nothing is saved from then on.
class Diverged : public RunError {
 public:
  using RunError::RunError;
};

/// Views and LPIPS of a training. Photos are certain; proposals are weighted by their confidence and have the mean
/// exposure of the photos.
struct TrainingData {
  // Not explicit: photos alone are what most runs learn from.
  TrainingData(std::vector<TrainView> photos_in = {}, std::vector<TrainView> proposals_in = {},
               PerceptualDistance lpips_in = {})
      : photos(std::move(photos_in)), proposals(std::move(proposals_in)), lpips(std::move(lpips_in)) {}

  std::vector<TrainView> photos;
  std::vector<TrainView> proposals;
  PerceptualDistance lpips;  ///< LPIPS for the proposals' loss; empty without a network
};

enum class TermKind {
  kPhotometric,  ///< PhotometricLoss of the image, seen through the exposure map where there is one
  kExposure,     ///< weight / 2 |map - identity|^2 of the exposure map
  kPerceptual,   ///< weight * LPIPS(image, target)
  kInvDepth,     ///< weight * mean(|inverse depth - target| * mask)
  kAlpha,        ///< weight * mean(|alpha - target| * mask)
};

/// A plane of a TrainView, wherever a device keeps it.
enum class ViewPlane { kNone, kImage, kPixelWeight, kInvDepth, kDepthMask, kAlpha };

struct LossTerm {
  TermKind kind{};
  double weight = 1;                                    ///< unused by kPhotometric, see photometric
  ViewPlane target = ViewPlane::kNone;                  ///< plane that the render is compared with
  ViewPlane mask = ViewPlane::kNone;                    ///< kNone: every pixel has weight 1
  PhotometricWeights photometric = {};                  ///< only for kPhotometric
  MaskMeaning mask_meaning = MaskMeaning::kConfidence;  ///< only for kPhotometric
};

/// The loss of one iteration is the sum of its terms, added up in their order.
class LossTerms {
 public:
  static constexpr int kMaxTerms = 6;

  /// Throws ShapeError for more than kMaxTerms.
  void Add(const LossTerm& term) {
    if (count_ == kMaxTerms) throw ShapeError("LossTerms: an iteration has more than {} terms", kMaxTerms);
    terms_[static_cast<size_t>(count_++)] = term;
  }
  const LossTerm* begin() const { return terms_.data(); }
  const LossTerm* end() const { return terms_.data() + count_; }

  /// The exposure map applied to the render. It is stepped with this learning rate; 0 = not stepped.
  std::optional<int> exposure;
  double exposure_rate = 0;

 private:
  std::array<LossTerm, kMaxTerms> terms_{};
  int count_ = 0;
};

/// The views of a run and the loss of each (docs/method.md#losses):
/// - photo: (1 - s) mean|I^ - I| + s mean(1 - SSIM), s = ssim_weight, over the pixels of its mask, through its exposure
///   map when those are trained;
/// - proposal: (1 - s - l) mean(|I^ - I| U) + s mean((1 - SSIM) U) + l mean(U) LPIPS(I^, I), U the confidence, s =
///   proposal_ssim, l = proposal_lpips, which is added to L1's share without a network;
/// - view with inv_depth also: depth_weight * 0.01^t * CharacteristicDepth * mean(|inv_depth - rendered| * depth_mask)
///   (docs/method.md#depth-term);
/// - view with alpha also: alpha_weight * mean(|alpha - rendered| * confidence).
/// Iterations count from 1.
class LossPlan {
 public:
  /// Throws UsageError when there is no photo or the shares of the loss sum to more than 1,
  /// ShapeError when a view does not fit; see CheckViews and CheckProposals.
  LossPlan(const TrainOptions& options, TrainingData data);

  LossTerms Terms(const SampledView& sampled, int64_t iteration) const;
  /// The sampled view.
  const TrainView& View(const SampledView& sampled) const;

  const std::vector<TrainView>& photos() const { return photos_; }
  const std::vector<TrainView>& Views(ViewKind kind) const {
    return kind == ViewKind::kProposal ? proposals_ : photos_;
  }
  int num_photos() const { return static_cast<int>(photos_.size()); }
  int num_proposals() const { return static_cast<int>(proposals_.size()); }
  bool has_lpips() const { return static_cast<bool>(lpips_); }
  const PerceptualDistance& lpips() const { return lpips_; }
  const TrainOptions& options() const { return options_; }
  /// Start of each photo's exposure map; empty where no maps are trained.
  std::vector<ExposureMap> StartExposures() const;

 private:
  LossTerm PhotometricTerm(ViewKind kind, const TrainView& view) const;

  TrainOptions options_;
  std::vector<TrainView> photos_, proposals_;
  std::vector<double> mean_confidence_;  // of the proposals
  PerceptualDistance lpips_;
  double depth_scale_;  // of the depth term at the start of the run, world units; 0 = there is none
};

/// Throws RunError that names the iteration and the view when the loss is not finite.
void RequireFinite(double loss, int64_t iteration, const TrainView& view);

}  // namespace oraclegs
