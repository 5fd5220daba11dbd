#include "oraclegs/train/trainer.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/scene/looked_at.h"
#include "oraclegs/train/floaters.h"
#include "oraclegs/train/mcmc.h"
#include "oraclegs/train/opacity_factors.h"
#include "oraclegs/train/rows.h"
#include "oraclegs/train/schedule.h"

namespace oraclegs {
namespace {

constexpr double kLossSmoothing = 0.9;  // share of the past in the loss that is shown
constexpr int64_t kReportEvery = 100;   // iterations
constexpr double kReportSeconds = 0.5;

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

}  // namespace

struct Trainer::State {
  State(const TrainOptions& train_options, uint64_t run_seed, std::array<float, 3> color, TrainingData data,
        const Gaussians& start)
      : options(train_options.Settled()),
        seed(run_seed),
        background(color),
        view_loss(options, std::move(data)),
        extent(SpatialExtent(Cameras(view_loss.photographs()))),
        gaussians(Clone(start)),
        adam(start.size()),
        sampler(run_seed, view_loss.num_photographs(), view_loss.num_proposals()),
        rasterizer(MakeRasterizer(torch::kCPU)) {}

  Tensor OpacityFactors();
  double BackwardAndStep(const RenderGrads& upstream, const LearningRates& rates, int sh_degree);
  void Refine(double lr_means);
  void TellWhatIsMissing(const Listener& listener) const;
  bool IsLast(int64_t i) const { return i >= options.iterations; }
  bool Refines(int64_t i) const {
    return i > options.refine_start && static_cast<double>(i) < options.refine_stop * options.iterations &&
           i % options.refine_every == 0;
  }

  // What a run is; the loss also holds the exposure maps, which a checkpoint has.
  TrainOptions options;
  uint64_t seed;
  std::array<float, 3> background;
  ViewLoss view_loss;
  double extent;

  // What a checkpoint holds.
  int64_t iteration = 0;
  Gaussians gaussians;
  Adam adam;
  ViewSampler sampler;
  double seconds = 0, loss = 0;
  nlohmann::json run_options;
  bool restored = false;

  // What is only reused.
  std::unique_ptr<Rasterizer> rasterizer;
  Regularizers regularizers;
  Tensor opacity_factors;              // [N]
  TrainTimings last_timings, timings;  // of the last iteration; sums
  int64_t timed_since = 0;             // iteration
};

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
  if (options.prune_floaters) PruneFloaters(view_loss.photographs(), &gaussians);
  RelocateDead(seed, i, &gaussians, &adam);
  AddGaussians(seed, i, options.max_gaussians, &gaussians, &adam);
  AddNoise({seed, i, lr_means}, &gaussians);
}

void Trainer::State::TellWhatIsMissing(const Listener& listener) const {
  if (extent == 0) {
    listener(Warning{"all training cameras stand in one place: the Gaussians keep the positions they start from"});
  }
  const ProposalSchedule schedule = options.Proposals();
  const bool uses_proposals =
      view_loss.num_proposals() > 0 && schedule.floor + schedule.peak > 0 && options.proposal_weight > 0;
  if (uses_proposals && options.proposal_lpips > 0 && !view_loss.has_lpips()) {
    listener(
        Note{fmt::format("there is no LPIPS network: its share of the proposals' loss goes to L1, which has {:.2f}; "
                         "`oraclegs models fetch lpips-vgg` brings one",
                         1 - options.proposal_ssim)});
  }
}

Trainer::Trainer(const TrainOptions& options, uint64_t seed, std::array<float, 3> background, TrainingData data,
                 Gaussians start) {
  CheckOptions(options);
  start.Check("Trainer");
  if (start.size() == 0) throw UsageError("there is no Gaussian to start from");
  state_ = std::make_unique<State>(options, seed, background, std::move(data), start);
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
  if (Exposures* exposures = s.view_loss.exposures()) exposures->Restore(checkpoint.exposures);
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
  const SampledView sampled = s.sampler.Next(SyntheticProbability(i, s.options.iterations, s.options.Proposals()));
  const TrainView& view = s.view_loss.View(sampled, i);

  const RenderOptions render{s.background, degree, s.options.antialiased, s.OpacityFactors()};
  const RenderOutput out = s.rasterizer->Forward(s.gaussians, view.camera, render, RenderPass::kTrain);
  TrainTimings& timings = s.last_timings = {};
  double rendering = 0;  // the rasteriser times its own stages
  lap.To(&rendering);
  const ViewLossResult of_view = s.view_loss(sampled, i, out);
  lap.To(&timings.loss);
  const double loss = of_view.loss + s.BackwardAndStep(of_view.grads, rates, degree);
  RequireFinite(loss, i, view);
  timings.render = s.rasterizer->timings();
  lap.To(&rendering);
  if (s.Refines(i)) s.Refine(rates.means);
  lap.To(&timings.refine);
  s.timings.Add(timings);
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
  s.TellWhatIsMissing(listener);
  const int64_t total = s.options.iterations;
  const double seconds_before = s.seconds;
  const Stopwatch watch;
  const auto save = [&] {
    CheckFinite(s.gaussians, s.iteration);
    WriteCheckpoint(CheckpointPath(policy.dir, s.iteration), MakeCheckpoint());
    RemoveOldCheckpoints(policy.dir, s.iteration);
  };
  int64_t reported = s.iteration;
  Stopwatch since_report;
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
    s.seconds = seconds_before + watch.Seconds();
    if (!policy.dir.empty() && policy.every > 0 && s.iteration % policy.every == 0) save();
    if (s.iteration - reported >= kReportEvery || since_report.Seconds() >= kReportSeconds || s.iteration == total) {
      reported = s.iteration;
      since_report = Stopwatch();
      listener(StepDone{"train", s.iteration, total, "iterations",
                        fmt::format("loss {:.4f}, {} Gaussians", s.loss, s.gaussians.size())});
    }
  }
  CheckFinite(s.gaussians, s.iteration);
  s.timings.total = watch.Seconds() * 1000;
  return {s.iteration, s.seconds, s.iteration - s.timed_since, MeanTimings()};
}

const Gaussians& Trainer::gaussians() const { return state_->gaussians; }

Tensor Trainer::exposures() const {
  const Exposures* exposures = std::as_const(state_->view_loss).exposures();
  if (exposures == nullptr) return {};
  const std::vector<ExposureMap>& maps = exposures->maps();
  Tensor result = torch::empty({static_cast<int64_t>(maps.size()), 3, 4}, torch::kFloat);
  std::memcpy(result.data_ptr<float>(), maps.data(), maps.size() * sizeof(ExposureMap));
  return result;
}

int64_t Trainer::iteration() const { return state_->iteration; }

TrainTimings Trainer::MeanTimings() const { return state_->timings.Mean(state_->iteration - state_->timed_since); }

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
  if (const Exposures* exposures = s.view_loss.exposures()) checkpoint.exposures = exposures->state();
  checkpoint.seconds = s.seconds;
  checkpoint.loss = s.loss;
  checkpoint.options = s.run_options;
  return checkpoint;
}

}  // namespace oraclegs
