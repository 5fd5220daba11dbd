#include "oraclegs/baselines/methods.h"

#include <algorithm>

#include "oraclegs/baselines/adaptive_density.h"
#include "oraclegs/baselines/correlated_depth.h"
#include "oraclegs/baselines/covisibility.h"
#include "oraclegs/baselines/depth_steps.h"
#include "oraclegs/baselines/mode_floaters.h"
#include "oraclegs/baselines/pseudo_depths.h"
#include "oraclegs/baselines/random_background.h"
#include "oraclegs/baselines/settings.h"
#include "oraclegs/baselines/two_fields.h"
#include "oraclegs/core/text.h"
#include "oraclegs/loss/depth_losses.h"

namespace oraclegs {
namespace {

/// 3DGS with adaptive density control [Kerbl 2023].
BaselineMethod Adaptive(const char* word) {
  BaselineMethod method{word, Published3dgs()};
  method.train.opacity_reg = method.train.scale_reg = 0;
  method.train.refine_stop = 0.5;
  method.train.max_gaussians = 500000;
  method.own.adaptive = true;
  return method;
}

/// Settings that the programs of FSGS, CoR-GS and DropGaussian share for few photos: fewer clones, densification until
/// the end, no size pruning.
BaselineMethod ForFewPhotos(const char* word) {
  BaselineMethod method = Adaptive(word);
  method.train.refine_stop = 1;
  method.own.densify_gradient = 0.0005;
  method.own.keep_large = true;
  return method;
}

BaselineMethod DropGaussian() {
  BaselineMethod method = ForFewPhotos("dropgaussian");
  method.train.dropout = 0.2;
  return method;
}

BaselineMethod Fsgs(const char* word) {
  BaselineMethod method = ForFewPhotos(word);
  method.train.sh_degree_interval = 500;
  method.own.depth_correlation = kFsgsDepthWeight;
  method.own.late_correlation = kFsgsLateDepthWeight / kFsgsDepthWeight;
  method.own.pseudo_depth_weight = 0.05;
  method.own.opacity_reset_first = 2001;
  method.own.opacity_reset_to = 0.05;
  method.own.proximity_split = true;
  method.own.unpool_until = 2000;
  return method;
}

BaselineMethod FsgsOfLlff() {
  BaselineMethod method = Fsgs("fsgs-llff");
  method.own.pseudo_depth_weight = 0.5;
  method.own.pseudo_depth_every = 1;
  return method;
}

BaselineMethod FsgsOfMipNerf360() {
  BaselineMethod method = Fsgs("fsgs-mipnerf360");
  method.own.pseudo_depth_weight = 0.03;
  return method;
}

BaselineMethod CorGs(const char* word) {
  BaselineMethod method = ForFewPhotos(word);
  method.train.sh_degree_interval = 500;
  method.own.two_fields = true;
  method.own.opacity_reset_first = 501;
  method.own.opacity_reset_to = 0.05;
  method.own.random_background = true;
  method.own.proximity_split = true;
  return method;
}

BaselineMethod CorGsOfDtu() {
  BaselineMethod method = CorGs("cor-gs-dtu");
  method.own.co_prune_distance = 10;
  method.own.co_start = 2000;
  return method;
}

BaselineMethod CorGsOfBlender() {
  BaselineMethod method = CorGs("cor-gs-blender");
  method.own.random_background = false;
  return method;
}

BaselineMethod CorGsOfMipNerf360() {
  BaselineMethod method = CorGs("cor-gs-mipnerf360");
  method.train.iterations = 30000;
  method.train.refine_stop = 0.5;
  method.own.co_prune_distance = 20;
  return method;
}

BaselineMethod DnGaussian(const char* word) {
  BaselineMethod method = Adaptive(word);
  method.train.iterations = 6000;
  method.train.refine_stop = 1;
  method.own.densify_gradient = 0.0005;
  method.own.hard_depth = true;
  method.own.soft_depth_start = 1000;
  method.own.depth_tolerance = 0.01;
  return method;
}

/// DNGaussian on datasets of photos.
BaselineMethod DnGaussianOfPhotos(const char* word, double gradient) {
  BaselineMethod method = DnGaussian(word);
  method.own.depth_step_every = 1;
  method.own.densify_opacity = 0.1;
  method.own.prune_opacity = 0.01;
  method.own.densify_gradient = gradient;
  return method;
}

BaselineMethod DnGaussianOfLlff() {
  BaselineMethod method = DnGaussianOfPhotos("dngaussian-llff", 0.0013);
  method.own.depth_tolerance = 0.00025;
  return method;
}

BaselineMethod DnGaussianOfBlender() {
  BaselineMethod method = DnGaussian("dngaussian-blender");
  method.own.soft_depth_start = 0;
  return method;
}

/// The published run has 30000 iterations, prunes at 20000 and densifies until 18000.
BaselineMethod SparseGs() {
  BaselineMethod method = Adaptive("sparsegs");
  method.train.refine_stop = 0.6;
  method.own.depth_correlation = kSparseGsDepthWeight;
  method.own.patched_correlation = kSparseGsPatchDepthWeight / kSparseGsDepthWeight * kSparseGsDepthWeight;
  method.own.prune_opacity = 0.05;
  method.own.prune_modes_at = 6667;
  return method;
}

BaselineMethod CoMapGs() {
  BaselineMethod method = ForFewPhotos("comapgs");
  method.own.covisibility_weights = true;
  return method;
}

}  // namespace

AutoTrainOptions Published3dgs() {
  AutoTrainOptions train;
  train.iterations = 10000;
  train.horizon = 0;
  train.max_gaussians = {};
  train.depth_weight = 0;
  train.depth_loss = DepthLoss::kRelative;
  train.alpha_weight = 0;
  train.exposure = ExposureMode::kOff;
  train.dropout = 0;
  train.opacity_noise = 0;
  train.prune_floaters = false;
  train.largest_scale = 0;
  train.rate_scale = 1;
  train.last_rates = 1;
  train.opacity_reg = train.scale_reg = 0.01;
  train.ssim_weight = 0.2;
  train.refine_start = 500;
  train.refine_every = 100;
  train.refine_stop = 25.0 / 30;
  train.sh_degree_interval = 1000;
  train.sh_degree = 3;
  train.sh_moments = ShMoments::kFull;
  train.antialiased = false;
  train.random_points = 100000;
  return train;
}

const std::vector<BaselineMethod>& BaselineMethods() {
  static const std::vector<BaselineMethod> methods = {
      Adaptive("3dgs"),
      {"3dgs-mcmc", Published3dgs()},
      {"3dgs-mcmc-random", Published3dgs()},
      DropGaussian(),
      Fsgs("fsgs"),
      FsgsOfLlff(),
      FsgsOfMipNerf360(),
      CorGs("cor-gs"),
      CorGsOfDtu(),
      CorGsOfBlender(),
      CorGsOfMipNerf360(),
      DnGaussian("dngaussian"),
      DnGaussianOfLlff(),
      DnGaussianOfPhotos("dngaussian-dtu", 0.001),
      DnGaussianOfBlender(),
      SparseGs(),
      CoMapGs(),
  };
  return methods;
}

const BaselineMethod& FindBaseline(std::string_view word) {
  std::vector<std::string> words;
  for (const BaselineMethod& method : BaselineMethods()) {
    if (method.word == word) return method;
    words.push_back(method.word);
  }
  throw UsageError("--set method is '{}'; there are {}{}", word, fmt::join(words, ", "), DidYouMean(word, words));
}

BaselineSettings MethodOptions::Settings() const {
  return method.empty() ? BaselineSettings() : FindBaseline(method).own;
}

const BaselineMethod& BaselineFor(const std::string& method, const std::string& dataset) {
  const std::vector<BaselineMethod>& all = BaselineMethods();
  const std::string own = method + "-" + dataset;
  const auto found = std::find_if(all.begin(), all.end(), [&](const BaselineMethod& m) { return m.word == own; });
  return found == all.end() ? FindBaseline(method) : *found;
}

void CheckBaseline(std::string_view method, const BaselineSettings& settings, const AutoTrainOptions& options) {
  if (!options.iterations.is_auto() && settings.prune_modes_at > options.iterations.value()) {
    throw UsageError("{} prunes at iteration {}, which lies beyond the last of {} --iterations; give more", method,
                     settings.prune_modes_at, options.iterations.value());
  }
  if (settings.adaptive && options.prune_floaters) {
    throw UsageError("--prune-floaters belongs to relocation, which {} does not have; leave it out", method);
  }
}

void AddBaseline(BaselineSetup* setup) {
  const BaselineSettings& settings = setup->baseline;
  if (settings.covisibility_weights) setup->data.photos = WeightByCovisibility(std::move(setup->data.photos));
  if (settings.adaptive) setup->densifier = AdaptiveDensifierMaker(settings, setup->background);
  if (settings.two_fields) setup->parts.push_back(std::make_shared<TwoFields>(*setup));
  if (settings.random_background) {
    setup->parts.push_back(std::make_shared<RandomBackgrounds>(setup->view_seed.value_or(setup->seed)));
  }
  if (settings.StepsByDepth()) setup->parts.push_back(std::make_shared<DepthSteps>(*setup));
  if (settings.depth_correlation > 0) setup->parts.push_back(std::make_shared<CorrelatedDepth>(*setup));
  if (settings.pseudo_depth_weight > 0) setup->parts.push_back(std::make_shared<PseudoDepths>(*setup));
  if (settings.prune_modes_at > 0) setup->parts.push_back(std::make_shared<PruneModes>(*setup));
}

}  // namespace oraclegs
