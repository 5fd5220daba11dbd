#include "oraclegs/train/trainer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/depth.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/render/image_buffer.h"
#include "oraclegs/scene/looked_at.h"
#include "oraclegs/train/coarse.h"
#include "oraclegs/train/floaters.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/opacity_factors.h"
#include "oraclegs/train/rows.h"
#include "oraclegs/train/schedule.h"

namespace oraclegs {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLossSmoothing = 0.9;  // share of the past in the loss that is shown
constexpr int64_t kReportEvery = 100;   // iterations
constexpr double kReportSeconds = 0.5;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Adds the milliseconds since the last lap to a stage.
class Lap {
 public:
  void To(double* milliseconds) {
    const auto now = Clock::now();
    *milliseconds += std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

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

std::vector<Camera> Cameras(const std::vector<TrainView>& views) {
  std::vector<Camera> cameras;
  for (const TrainView& view : views) cameras.push_back(view.camera);
  return cameras;
}

std::vector<TrainView> WithCleanDepths(std::vector<TrainView> views) {
  for (TrainView& view : views) view = WithCleanDepth(std::move(view));
  return views;
}

std::vector<TrainView> HalfSizes(const std::vector<TrainView>& views) {
  std::vector<TrainView> halves;
  for (const TrainView& view : views) halves.push_back(HalfSize(view));
  return halves;
}

std::vector<ExposureMap> StartExposures(const std::vector<TrainView>& views) {
  std::vector<ExposureMap> maps;
  for (const TrainView& view : views) maps.push_back(view.exposure);
  return maps;
}

/// The stages, in the order of the declaration; Run measures the total apart.
std::array<double*, 8> Stages(TrainTimings* t) {
  return {&t->render.project,           &t->render.bin, &t->render.blend, &t->render.blend_backward,
          &t->render.gaussian_backward, &t->loss,       &t->refine,       &t->total};
}

/// Throws unless the options a checkpoint was saved with are these; names the first that differs.
void CheckSameOptions(const std::filesystem::path& dir, const nlohmann::json& saved, const nlohmann::json& now) {
  if (DumpOptions(saved) == DumpOptions(now)) return;
  std::string difference = "other options";
  for (const auto& [name, value] : saved.items()) {
    if (!now.is_object() || !now.contains(name) || DumpOptions(now[name]) == DumpOptions(value)) continue;
    difference = fmt::format("{} {}, not {}", name, DumpOptions(value), DumpOptions(now[name]));
    break;
  }
  throw InputError("{}: the checkpoint was made with {}; continue with those options or choose another folder",
                   dir.string(), difference);
}

void CheckFinite(const Gaussians& gaussians, int64_t iteration) {
  gaussians.ForEach([&](const char* name, const Tensor& t) {
    if (torch::isfinite(t).all().item<bool>()) return;
    throw RunError(
        "{} of a Gaussian are not finite at iteration {}: training has diverged; check the poses and the "
        "scale of the scene",
        name, iteration);
  });
}

TrainTimings Mean(TrainTimings sum, int64_t iterations) {
  for (double* stage : Stages(&sum)) *stage /= static_cast<double>(std::max<int64_t>(iterations, 1));
  return sum;
}

}  // namespace

struct Trainer::State {
  State(const TrainOptions& train_options, uint64_t run_seed, std::array<float, 3> color,
        std::vector<TrainView> photographs, const Gaussians& start)
      : options(train_options.Settled()),
        seed(run_seed),
        background(color),
        views(WithCleanDepths(std::move(photographs))),
        extent(SpatialExtent(Cameras(views))),
        coarse_iterations(CoarseIterations(options.coarse_share, options.iterations)),
        half_views(coarse_iterations > 0 ? HalfSizes(views) : std::vector<TrainView>()),
        depth_scale(options.depth_weight * CharacteristicDepth(views)),
        gaussians(Clone(start)),
        adam(start.size()),
        sampler(run_seed, static_cast<int>(views.size()), 0),
        rasterizer(MakeRasterizer(torch::kCPU)) {
    if (options.exposure == "on") exposures.emplace(StartExposures(views));
  }

  double PhotographLoss(const TrainView& view, const Tensor& image, Tensor* grad);
  const TrainView& ViewNow(int index) const;
  double ExposedLoss(int index, const Tensor& image, Tensor* grad);
  Tensor OpacityFactors();
  double DepthTerm(const TrainView& view, const Tensor& inv_depth, Tensor* grad);
  double BackwardAndStep(const RenderGrads& upstream, const LearningRates& rates, int sh_degree);
  void Refine(double lr_means);
  void RequireFinite(double value, const TrainView& view) const;
  bool IsLast(int64_t i) const { return i >= options.iterations; }
  bool Refines(int64_t i) const {
    return i > options.refine_start && static_cast<double>(i) < options.refine_stop * options.iterations &&
           i % options.refine_every == 0;
  }

  // What a run is.
  TrainOptions options;
  uint64_t seed;
  std::array<float, 3> background;
  std::vector<TrainView> views;
  double extent;
  int64_t coarse_iterations;
  std::vector<TrainView> half_views;  // none without coarse iterations
  double depth_scale;                 // of the depth term at the start of the run, world units; 0 = there is none

  // What a checkpoint holds.
  int64_t iteration = 0;
  Gaussians gaussians;
  Adam adam;
  ViewSampler sampler;
  std::optional<Exposures> exposures;
  double seconds = 0, loss = 0;
  nlohmann::json run_options;
  bool restored = false;

  // What is only reused.
  std::unique_ptr<Rasterizer> rasterizer;
  PhotometricLoss photometric;
  Regularizers regularizers;
  Tensor opacity_factors;  // [N]
  ImageBuffer grad_image, grad_inv_depth, masked_image, exposed_image;
  TrainTimings last_timings, timings;  // of the last iteration; sums
  int64_t timed_since = 0;             // iteration
};

/// The view as this iteration sees it.
const TrainView& Trainer::State::ViewNow(int index) const {
  return iteration < coarse_iterations ? half_views[index] : views[index];
}

/// Undefined, which the rasteriser takes for 1 at no cost, where no opacity is perturbed. The last iteration shows the
/// model as it will be used.
Tensor Trainer::State::OpacityFactors() {
  const int64_t i = iteration + 1;
  const OpacityPerturbation perturbation{seed, i, DropProbability(options.dropout, i, options.iterations),
                                         IsLast(i) ? 0 : options.opacity_noise};
  if (!perturbation.IsActive()) return {};
  if (!opacity_factors.defined() || opacity_factors.numel() != gaussians.size()) {
    opacity_factors = torch::empty({gaussians.size()}, torch::kFloat);
  }
  DrawOpacityFactors(perturbation, opacity_factors);
  return opacity_factors;
}

double Trainer::State::PhotographLoss(const TrainView& view, const Tensor& image, Tensor* grad) {
  const PhotometricWeights weights{static_cast<float>(1 - options.ssim_weight),
                                   static_cast<float>(options.ssim_weight)};
  if (!view.confidence.defined()) return photometric(image, view.image, {}, weights, grad).loss;
  // SSIM looks 5 pixels around: where the mask is zero the render is replaced by the photograph, so that what stands
  // there says nothing about the pixels that count, and takes no gradient from them.
  const Tensor masked = masked_image.Get({view.camera.height, view.camera.width, 3});
  SelectByMask(view.confidence, image, view.image, masked);
  const double value = photometric(masked, view.image, view.confidence, weights, grad).loss;
  SelectByMask(view.confidence, *grad, {}, *grad);
  return value;
}

/// The loss of a view whose photograph saw the scene through an exposure map of its own, which learns from it. The last
/// iteration moves no map.
double Trainer::State::ExposedLoss(int index, const Tensor& image, Tensor* grad) {
  const TrainView& view = ViewNow(index);
  if (!exposures) return PhotographLoss(view, image, grad);
  const Tensor exposed = exposed_image.Get({view.camera.height, view.camera.width, 3});
  exposures->Apply(index, image, exposed);
  double value = PhotographLoss(view, exposed, grad);
  ExposureGradient gradient = exposures->Backward(index, image, *grad);
  value += exposures->AddPull(index, &gradient);
  RequireFinite(value, view);
  const int64_t i = iteration + 1;
  if (!IsLast(i)) exposures->Step(index, gradient, ExposureLearningRate(i, options.iterations));
  return value;
}

/// Leaves `grad` undefined, which the rasteriser takes for zero at no cost, where there is no depth to learn from.
double Trainer::State::DepthTerm(const TrainView& view, const Tensor& inv_depth, Tensor* grad) {
  if (depth_scale == 0 || !view.inv_depth.defined()) return 0;
  *grad = grad_inv_depth.Get({view.camera.height, view.camera.width});
  const double weight = depth_scale * DepthWeight(iteration + 1, options.iterations);
  return DepthLoss(inv_depth, view.inv_depth, view.depth_mask, weight, grad);
}

/// Everything between the gradient of the image and the moved Gaussians, block by block: gradients are used up while
/// they are in the cache. Returns the value of the regularisers. The last iteration moves nothing.
double Trainer::State::BackwardAndStep(const RenderGrads& upstream, const LearningRates& rates, int sh_degree) {
  const int64_t i = iteration + 1;
  regularizers.Begin(gaussians, options.opacity_reg, options.scale_reg);
  if (IsLast(i)) {
    rasterizer->BackwardBlocks(gaussians, upstream, [&](int64_t begin, int64_t end, const GaussianRows& grads) {
      regularizers.AddTo(begin, end, grads);
    });
    return regularizers.Value();
  }
  const AdamStep step = adam.BeginStep(rates, sh_degree, &gaussians);
  const MeansNoise noise{seed, i, rates.means};
  const bool add_noise = !Refines(i);  // else it comes after relocation and growth
  rasterizer->BackwardBlocks(gaussians, upstream, [&](int64_t begin, int64_t end, const GaussianRows& grads) {
    regularizers.AddTo(begin, end, grads);
    step.Update(begin, end, grads);
    if (add_noise) AddNoiseToBlock(noise, begin, end, &gaussians);
  });
  return regularizers.Value();
}

/// Never the last iteration: refine_stop is at most 1.
void Trainer::State::Refine(double lr_means) {
  const int64_t i = iteration + 1;
  if (options.prune_floaters) PruneFloaters(views, &gaussians);
  RelocateDead(seed, i, &gaussians, &adam);
  AddGaussians(seed, i, options.max_gaussians, &gaussians, &adam);
  AddNoise({seed, i, lr_means}, &gaussians);
}

void Trainer::State::RequireFinite(double value, const TrainView& view) const {
  if (std::isfinite(value)) return;
  throw RunError(
      "the loss is {} at iteration {} on {}: training has diverged; check the poses and the scale of the scene", value,
      iteration + 1, view.name);
}

Trainer::Trainer(const TrainOptions& options, uint64_t seed, std::array<float, 3> background,
                 std::vector<TrainView> photographs, Gaussians start) {
  CheckOptions(options);
  CheckViews(photographs);
  start.Check("Trainer");
  if (start.size() == 0) throw UsageError("there is no Gaussian to start from");
  state_ = std::make_unique<State>(options, seed, background, std::move(photographs), start);
}

Trainer::~Trainer() = default;

void Trainer::Restore(const Checkpoint& checkpoint) {
  State& s = *state_;
  if (checkpoint.iteration > s.options.iterations) {
    throw InputError("the checkpoint stands at iteration {}, this run ends at {}", checkpoint.iteration,
                     s.options.iterations);
  }
  checkpoint.gaussians.Check("Trainer::Restore");
  const int64_t n = checkpoint.gaussians.size();
  if (n == 0 || checkpoint.adam.m.size() != n || checkpoint.adam.v.size() != n) {
    throw InputError("the checkpoint holds {} Gaussians and moments of {} and {}", n, checkpoint.adam.m.size(),
                     checkpoint.adam.v.size());
  }
  s.sampler.Restore(checkpoint.sampler);
  if (s.exposures) s.exposures->Restore(checkpoint.exposures);
  s.iteration = checkpoint.iteration;
  s.gaussians = Clone(checkpoint.gaussians);
  s.adam.m = Clone(checkpoint.adam.m);
  s.adam.v = Clone(checkpoint.adam.v);
  s.adam.step = checkpoint.adam.step;
  s.seconds = checkpoint.seconds;
  s.loss = checkpoint.loss;
  s.run_options = checkpoint.options;
  s.restored = true;
  s.timings = {};
  s.timed_since = s.iteration;
}

double Trainer::Step() {
  State& s = *state_;
  const int64_t i = s.iteration + 1;
  Lap lap;
  LearningRates rates;
  rates.ScaleAll(RateFactor(i, s.options.iterations, s.options.last_rates));
  rates.means = MeansLearningRate(i, s.options.iterations, s.extent);
  const int degree = std::min(ActiveShDegree(i, s.options.sh_degree_interval), s.options.sh_degree);
  const int index = s.sampler.Next(0).index;
  const TrainView& view = s.ViewNow(index);

  const RenderOptions render{s.background, degree, s.options.antialiased, s.OpacityFactors()};
  const RenderOutput out = s.rasterizer->Forward(s.gaussians, view.camera, render, RenderPass::kTrain);
  TrainTimings& timings = s.last_timings = {};
  double rendering = 0;  // the rasteriser times its own stages
  lap.To(&rendering);
  Tensor grad_image = s.grad_image.Get({view.camera.height, view.camera.width, 3});
  Tensor grad_inv_depth;
  double loss = s.ExposedLoss(index, out.image, &grad_image) + s.DepthTerm(view, out.inv_depth, &grad_inv_depth);
  s.RequireFinite(loss, view);
  lap.To(&timings.loss);
  loss += s.BackwardAndStep({grad_image, {}, grad_inv_depth}, rates, degree);
  s.RequireFinite(loss, view);
  timings.render = s.rasterizer->timings();
  lap.To(&rendering);
  if (s.Refines(i)) s.Refine(rates.means);
  lap.To(&timings.refine);
  for (size_t k = 0; k < Stages(&timings).size(); ++k) *Stages(&s.timings)[k] += *Stages(&timings)[k];
  s.iteration = i;
  s.loss = i == 1 ? loss : kLossSmoothing * s.loss + (1 - kLossSmoothing) * loss;
  return loss;
}

TrainResult Trainer::Run(const CheckpointPolicy& policy, const Listener& listener) {
  State& s = *state_;
  if (s.restored) CheckSameOptions(policy.dir, s.run_options, policy.options);
  s.run_options = policy.options;
  s.timings = {};
  s.timed_since = s.iteration;
  if (s.extent == 0) {
    listener(Warning{"all training cameras stand in one place: the Gaussians keep the positions they start from"});
  }
  const int64_t total = s.options.iterations;
  const double seconds_before = s.seconds;
  const auto start = Clock::now();
  const auto save = [&] {
    CheckFinite(s.gaussians, s.iteration);
    WriteCheckpoint(CheckpointPath(policy.dir, s.iteration), MakeCheckpoint());
    RemoveOldCheckpoints(policy.dir, s.iteration);
  };
  int64_t reported = s.iteration;
  auto report_time = start;
  while (s.iteration < total) {
    if (InterruptRequested()) {
      if (policy.dir.empty())
        throw Interrupted(fmt::format("interrupted at iteration {} of {}; nothing was saved", s.iteration, total));
      save();
      throw Interrupted(
          fmt::format("interrupted at iteration {} of {}, saved in {}; run the same command again to "
                      "continue",
                      s.iteration, total, CheckpointPath(policy.dir, s.iteration).string()));
    }
    Step();
    s.seconds = seconds_before + SecondsSince(start);
    if (!policy.dir.empty() && policy.every > 0 && s.iteration % policy.every == 0) save();
    if (s.iteration - reported >= kReportEvery || SecondsSince(report_time) >= kReportSeconds || s.iteration == total) {
      reported = s.iteration;
      report_time = Clock::now();
      listener(StepDone{"train", s.iteration, total, "iterations",
                        fmt::format("loss {:.4f}, {} Gaussians", s.loss, s.gaussians.size())});
    }
  }
  CheckFinite(s.gaussians, s.iteration);
  s.timings.total = SecondsSince(start) * 1000;
  return {s.iteration, s.seconds, s.iteration - s.timed_since, MeanTimings()};
}

const Gaussians& Trainer::gaussians() const { return state_->gaussians; }

Tensor Trainer::exposures() const {
  if (!state_->exposures) return {};
  const std::vector<ExposureMap>& maps = state_->exposures->maps();
  Tensor result = torch::empty({static_cast<int64_t>(maps.size()), 3, 4}, torch::kFloat);
  std::memcpy(result.data_ptr<float>(), maps.data(), maps.size() * sizeof(ExposureMap));
  return result;
}

int64_t Trainer::iteration() const { return state_->iteration; }

TrainTimings Trainer::MeanTimings() const { return Mean(state_->timings, state_->iteration - state_->timed_since); }

TrainTimings Trainer::LastTimings() const { return state_->last_timings; }

RenderStats Trainer::LastStats() const { return state_->rasterizer->stats(); }

Checkpoint Trainer::MakeCheckpoint() const {
  const State& s = *state_;
  Checkpoint checkpoint;
  checkpoint.iteration = s.iteration;
  checkpoint.gaussians = Clone(s.gaussians);
  checkpoint.adam.m = Clone(s.adam.m);
  checkpoint.adam.v = Clone(s.adam.v);
  checkpoint.adam.step = s.adam.step;
  checkpoint.sampler = s.sampler.state();
  if (s.exposures) checkpoint.exposures = s.exposures->state();
  checkpoint.seconds = s.seconds;
  checkpoint.loss = s.loss;
  checkpoint.options = s.run_options;
  return checkpoint;
}

}  // namespace oraclegs
