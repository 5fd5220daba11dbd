#pragma once

#include <cstdint>

#include "oraclegs/core/options.h"
#include "oraclegs/train/schedule.h"
#include "oraclegs/train/step_constants.h"

namespace oraclegs {

/// How the fraction of iterations that take a proposal changes over the run.
enum class ScheduleKind { kPaper, kFalling, kConstant, kUnion, kNone };
template <>
struct EnumWords<ScheduleKind> {
  static constexpr EnumWord<ScheduleKind> kWords[] = {{ScheduleKind::kPaper, "paper"},
                                                      {ScheduleKind::kFalling, "falling"},
                                                      {ScheduleKind::kConstant, "constant"},
                                                      {ScheduleKind::kUnion, "union"},
                                                      {ScheduleKind::kNone, "none"}};
};

/// Quantity that the depth term compares.
enum class DepthLoss {
  kRelative,  ///< inverse depths in units of the scene's typical distance, weighted by their confidence
  kPaper,     ///< inverse depths in units of the run under a mask of 0 and 1 (equation 5 of the OracleGS paper)
};
template <>
struct EnumWords<DepthLoss> {
  static constexpr EnumWord<DepthLoss> kWords[] = {{DepthLoss::kRelative, "relative"}, {DepthLoss::kPaper, "paper"}};
};

/// Whether exposure maps are trained.
enum class ExposureMode { kOn, kOff };
template <>
struct EnumWords<ExposureMode> {
  static constexpr EnumWord<ExposureMode> kWords[] = {{ExposureMode::kOn, "on"}, {ExposureMode::kOff, "off"}};
};

template <>
struct EnumWords<ShMoments> {
  static constexpr EnumWord<ShMoments> kWords[] = {
      {ShMoments::kFull, "full"}, {ShMoments::kHalf, "half"}, {ShMoments::kCompact, "compact"}};
};

/// Defaults where nothing chooses a size.
inline constexpr int kUsualIterations = 7000, kUsualMaxGaussians = 100000;

/// Training options that no scene decides.
struct TrainConstants {
  int horizon = 0;
  double depth_weight = 1;
  DepthLoss depth_loss = DepthLoss::kRelative;
  double alpha_weight = 0.1;
  bool prune_floaters = false;
  double largest_scale = 0.7;
  double opacity_reg = 0.01;
  double scale_reg = 0.01;
  double ssim_weight = 0.2;
  double synthetic_peak = ProposalSchedule().peak;
  double proposal_ssim = 0.3;
  double proposal_lpips = 0.3;
  double confidence_power = 1;
  double refine_stop = 25.0 / 30;
  int sh_degree = 3;
  ShMoments sh_moments = ShMoments::kHalf;
  bool antialiased = false;
  int random_points = 100000;
};

/// Everything that decides the numbers of a training run; without other values as 3DGS does.
struct TrainOptions : TrainConstants {
  int iterations = kUsualIterations;
  int max_gaussians = kUsualMaxGaussians;
  ExposureMode exposure = ExposureMode::kOff;
  double dropout = 0;
  double opacity_noise = 0;
  double rate_scale = 1;
  double last_rates = 1;
  ScheduleKind schedule = ScheduleKind::kPaper;
  double synthetic_floor = ProposalSchedule().floor;
  int refine_start = 500;
  int refine_every = 100;
  int sh_degree_interval = 1000;

  /// Number of iterations that the schedules of rates and weights span.
  int64_t Horizon() const { return horizon > 0 ? horizon : iterations; }

  /// Whether Gaussians may be added or removed after this iteration: before --set refine-stop, and never after the last
  /// one, whose model is scored without further training.
  bool IsBeforeRefineStop(int64_t iteration) const {
    return iteration < iterations && static_cast<double>(iteration) < refine_stop * static_cast<double>(Horizon());
  }
  /// Whether densification takes place after this iteration: every --set refine-every between --set refine-start and
  /// --set refine-stop.
  bool Refines(int64_t iteration) const {
    return IsBeforeRefineStop(iteration) && iteration > refine_start && iteration % refine_every == 0;
  }

  /// Probability schedule of proposals, as --schedule says.
  ProposalSchedule Proposals() const {
    if (schedule == ScheduleKind::kNone) return {0, 0};
    return {synthetic_floor, schedule == ScheduleKind::kPaper ? synthetic_peak : 0, schedule == ScheduleKind::kFalling};
  }

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("iterations", self.iterations, "Training steps, one photo each; auto = by --quality, pixels and device",
          Range{1, 1e7});
    visit("horizon", self.horizon,
          "Iterations over which learning rates, depth weight, schedule and --set refine-stop run their course, where "
          "training stops before that; 0 = --iterations. The paper scores a run of 30000 after 15000 or 22000",
          Range{0, 1e7}, Tier::kSetting);
    visit("max-gaussians", self.max_gaussians,
          "Growth stops at this many Gaussians; auto = by --quality, pixels and number of photos", Range{1, 1e8});
    visit("sh-degree", self.sh_degree, "Highest degree of the view-dependent color", Range{0, 3}, Tier::kSetting);
    visit("sh-degree-interval", self.sh_degree_interval,
          "Iterations between raises of the active degree; auto = a fifth of them all, at most 3DGS's 1000",
          Range{1, 1e7}, Tier::kSetting);
    visit(
        "sh-moments", self.sh_moments,
        "What Adam remembers of the view-dependent color: full = two numbers for each coefficient; half = the same in "
        "16 bits, as good, with a quarter less memory for Gaussians in training; compact = one of the two for all "
        "coefficients, with two fifths less memory, less sharp",
        Tier::kSetting);
    visit("antialiased", self.antialiased, "Train and render with opacity compensation for small Gaussians");
    visit("ssim-weight", self.ssim_weight, "Weight of 1-SSIM in the photometric loss, the rest is L1", Range{0, 1},
          Tier::kSetting);
    visit(
        "schedule", self.schedule,
        "How often an iteration takes a proposal instead of a photo: paper = synthetic-floor + synthetic-peak * "
        "t (1-t)^3 of them, t the share of the run that is done; falling = synthetic-floor in the first half, then "
        "linearly down to none; constant = synthetic-floor throughout; union = photos and proposals are drawn from one "
        "pile; none = never; auto = falling where proxy models alone propose, in proportion to their confidence, else "
        "paper");
    visit(
        "synthetic-floor", self.synthetic_floor,
        "Fraction of the iterations that take a proposal: at both ends of the run with --schedule paper, in its first "
        "half with falling; auto = half of the mean squared confidence where --schedule auto is falling, else the "
        "paper's 0.1",
        Range{0, 1}, Tier::kSetting);
    visit("synthetic-peak", self.synthetic_peak,
          "Factor of t (1-t)^3, which adds to the floor and is largest, 0.105, at a quarter of the run", Range{0, 100},
          Tier::kSetting);
    visit("proposal-ssim", self.proposal_ssim,
          "Weight of 1-SSIM in the loss on proposals; what SSIM and LPIPS leave is L1", Range{0, 1}, Tier::kSetting);
    visit("proposal-lpips", self.proposal_lpips,
          "Weight of LPIPS in the loss on proposals; L1 gets it where LPIPS's weights are missing", Range{0, 1},
          Tier::kSetting);
    visit("confidence-power", self.confidence_power,
          "Exponent applied to the confidence that weighs a pixel of a proposal; 0 = all above 0 weigh the same",
          Range{0, 100}, Tier::kSetting);
    visit("depth-weight", self.depth_weight,
          "Weight of the depth term where a photo has depth: mean |1/z - target| times the scene's typical "
          "distance, falling to a hundredth over the run (3DGS depth regularization, Kerbl et al. 2024); 0 = off",
          Range{0, 1e3});
    visit("depth-loss", self.depth_loss,
          "What the depth term compares: relative = as above, each pixel weighted by the confidence of its depth; "
          "paper = |1/z - target| in units of the run, all pixels of a network's depth alike, what it puts beyond "
          "infinity at 0 (equation 5 of the OracleGS paper)",
          Tier::kSetting);
    visit("alpha-weight", self.alpha_weight,
          "Weight of the alpha (silhouette) loss where images have an alpha channel: mean |alpha - rendered|; 0 = off",
          Range{0, 1e3}, Tier::kSetting);
    visit("exposure", self.exposure,
          "Learn a color map (3x4) for each photo, for cameras that chose exposure and white balance anew each "
          "time (3DGS exposure compensation, Kerbl et al. 2024); the scene gets the mean exposure. auto = where the "
          "colors of common surfaces differ");
    visit("dropout", self.dropout,
          "Dropout rate of the Gaussians at the end of training, growing linearly from 0 (the opacities of the others "
          "are raised to make up for it); reduces overfitting to few photos (DropGaussian, Park et al., CVPR 2025, "
          "uses 0.2); auto = 0.2 for an object before a plain background, else 0",
          Range{0, 0.95}, Tier::kSetting);
    visit(
        "opacity-noise", self.opacity_noise,
        "Standard deviation of the noise each opacity is multiplied by, 1 + s N(0,1), anew in every iteration; against "
        "Gaussians that look right only together (Chen et al., Quantifying and Alleviating Co-Adaptation in "
        "Sparse-View 3DGS, 2025, uses 0.8); auto = 0.5, 0.3 for an object before a plain background",
        Range{0, 10}, Tier::kSetting);
    visit("prune-floaters", self.prune_floaters,
          "At each relocation also move floaters: Gaussians at least 10 % in front of the depth maps of as many or "
          "more photos than confirm them; needs depth (compare SparseGS, Xiong et al. 2023)");
    visit("largest-scale", self.largest_scale,
          "Maximum standard deviation of a Gaussian, as a fraction of its distance to the nearest camera; larger ones "
          "fog the views between the photos; 0 = unlimited",
          Range{0, 1e3}, Tier::kSetting);
    visit("rate-scale", self.rate_scale,
          "Factor of the learning rates of 3DGS, all but the exposure's, and of the noise on positions; they are made "
          "for 30000 iterations, and too low for fewer. auto = sqrt(30000 / iterations), from 1 to 6",
          Range{1e-3, 100}, Tier::kSetting);
    visit("last-rates", self.last_rates,
          "Final factor of the learning rates of color, opacity, scale and rotation, which decay over the second half "
          "of the run; 1 = constant, as in 3DGS; auto = 0.1",
          Range{1e-6, 1}, Tier::kSetting);
    visit("opacity-reg", self.opacity_reg, "Weight of the mean opacity in the loss", Range{0, 1e3}, Tier::kSetting);
    visit("scale-reg", self.scale_reg, "Weight of the mean scale (units of the run) in the loss", Range{0, 1e3},
          Tier::kSetting);
    visit("random-points", self.random_points, "Points drawn when there are fewer than 100 to start from",
          Range{100, 1e8}, Tier::kSetting);
    visit("refine-start", self.refine_start,
          "Relocation and growth begin after this iteration; auto = a tenth of them all, at most 3DGS's 500",
          Range{0, 1e7}, Tier::kSetting);
    visit("refine-every", self.refine_every,
          "Iterations between relocations; auto = a fiftieth of them all, from 10 to 3DGS's 100", Range{1, 1e7},
          Tier::kSetting);
    visit("refine-stop", self.refine_stop, "Fraction of the iterations after which relocation and growth end",
          Range{0, 1}, Tier::kSetting);
  }
};

/// TrainOptions as the user asks for them.
struct AutoTrainOptions : TrainConstants {
  Auto<int> iterations;
  Auto<int> max_gaussians;
  Auto<ExposureMode> exposure;
  Auto<double> dropout;
  Auto<double> opacity_noise;
  Auto<double> rate_scale;
  Auto<double> last_rates;
  Auto<ScheduleKind> schedule;
  Auto<double> synthetic_floor;
  Auto<int> refine_start;
  Auto<int> refine_every;
  Auto<int> sh_degree_interval;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    TrainOptions::Visit(self, visit);
  }
};

}  // namespace oraclegs
