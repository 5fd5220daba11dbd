#include "oraclegs/train/trainer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/text.h"
#include "oraclegs/train/checkpoint_folder.h"
#include "oraclegs/train/densify.h"
#include "oraclegs/train/loss_terms.h"
#include "oraclegs/train/schedule.h"
#include "oraclegs/train/train_device.h"

namespace oraclegs {
namespace {

constexpr int64_t kReportEvery = 100;  // iterations
constexpr double kReportSeconds = 0.5;

void CheckFinite(const Gaussians& gaussians, int64_t iteration) {
  gaussians.ForEach([&](const char* name, const Buffer<float>& t) {
    const Buffer<float> host = t.To(kCpu);
    if (std::all_of(host.span().begin(), host.span().end(), [](float x) { return std::isfinite(x); })) return;
    throw Diverged(
        "{} of a Gaussian are not finite at iteration {}: training has diverged; check the poses and the "
        "scale of the scene",
        name, iteration);
  });
}

}  // namespace

struct Trainer::State {
  State(TrainSetup setup, const TrainDeviceMaker& make_device)
      : options(setup.options),
        seed(setup.seed),
        view_seed(setup.view_seed.value_or(seed)),
        background(setup.background),
        plan(options, std::move(setup.data)),
        extent(SpatialExtent(Cameras(plan.photos()))),
        parts(std::move(setup.parts)),
        device(make_device({options, plan, setup.start.size(), parts, std::move(setup.densifier)})),
        model(device->Upload({setup.start})),
        sampler(view_seed, plan.num_photos(), plan.num_proposals()) {}

  Iteration NextIteration();
  std::array<float, 3> BackgroundOf(const Iteration& next, const TrainView& view) const;
  Buffer<float> OpacityFactors();
  void Step();
  void ReportLimitations(const Listener& listener) const;
  bool IsLast(int64_t i) const { return i >= options.iterations; }

  // Setup of the run.
  TrainOptions options;
  uint64_t seed, view_seed;
  std::array<float, 3> background;
  LossPlan plan;
  double extent;
  MethodParts parts;
  std::unique_ptr<TrainDevice> device;

  // State in the checkpoint, together with the exposure maps and the smoothed loss, which the device holds.
  int64_t iteration = 0;
  TrainedModel model;  // on the device
  ViewSampler sampler;
  double seconds = 0;
  nlohmann::json run_options;
  bool restored = false;

  // Scratch.
  TrainTimings last_timings, timings;  // of the last iteration; sums
  int64_t timed_since = 0;             // iteration
};

Iteration Trainer::State::NextIteration() {
  Iteration next;
  const int64_t i = next.number = iteration + 1;
  next.seed = seed;
  next.rates.ScaleAll(RateFactor(i, options.Horizon(), options.last_rates));
  next.rates.means = MeansLearningRate(i, options.Horizon(), extent);
  next.rates.ScaleAll(options.rate_scale);
  next.sh_degree = std::min(ActiveShDegree(i, options.sh_degree_interval), options.sh_degree);
  next.view = sampler.Next(SyntheticProbability(i, options.Horizon(), options.Proposals()));
  next.moves = !IsLast(i);
  next.refines = options.Refines(i);
  // Also after the last relocation, since oversized Gaussians grow until the end.
  next.caps_scales = options.largest_scale > 0 && i % options.refine_every == 0;
  return next;
}

/// Opacity factors of the iteration. Undefined, which the rasterizer takes for 1 at no cost, where no opacity is
/// perturbed, as in the last iteration, whose loss is that of the final model.
Buffer<float> Trainer::State::OpacityFactors() {
  const int64_t i = iteration + 1;
  const OpacityPerturbation perturbation{seed, i, DropProbability(options.dropout, i, options.iterations),
                                         IsLast(i) ? 0 : options.opacity_noise};
  return perturbation.IsActive() ? device->OpacityFactors(perturbation, model.gaussians.size()) : Buffer<float>();
}

std::array<float, 3> Trainer::State::BackgroundOf(const Iteration& next, const TrainView& view) const {
  if (next.view.kind == ViewKind::kProposal) return background;
  for (const std::shared_ptr<MethodPart>& part : parts) {
    if (const auto own = part->Background(next, view)) return *own;
  }
  return background;
}

void Trainer::State::Step() {
  Lap lap;
  const Iteration next = NextIteration();
  last_timings = {};
  device->RunParts(next, &model);
  lap.To(&last_timings.parts);
  const TrainView& view = plan.View(next.view);
  const RenderOptions render{BackgroundOf(next, view), next.sh_degree, options.antialiased, OpacityFactors()};
  Rasterizer& rasterizer = device->rasterizer();
  const RenderOutput out = rasterizer.Forward(model.gaussians, view.camera, render, RenderPass::kTrain);
  double rendering = 0;  // the rasterizer times its own stages
  lap.To(&rendering);
  const RenderGrads upstream = device->LossOfView(next, out);
  lap.To(&last_timings.loss);
  device->BackwardAndStep(next, upstream, &model);
  last_timings.render = device->TimingsSoFar();
  lap.To(&rendering);
  if (next.caps_scales) device->CapScales(&model);
  device->Refine(next, &model);
  lap.To(&last_timings.refine);
  timings.Add(last_timings);
  iteration = next.number;
}

void Trainer::State::ReportLimitations(const Listener& listener) const {
  if (extent == 0) {
    listener(Warning{"all training cameras stand in one place: the Gaussians keep the positions they start from"});
  }
  if (device->expected_bytes() > 0) {
    listener(Note{fmt::format("the training needs about {:.3g} GB of GPU memory beside LPIPS",
                              Gigabytes(device->expected_bytes()))});
  }
}

Trainer::Trainer(const TrainOptions& options, uint64_t seed, std::array<float, 3> background, TrainingData data,
                 Gaussians start)
    : Trainer({options, seed, background, std::move(data), std::move(start)},
              [](const TrainDeviceSetup& setup) { return MakeTrainDevice(kCpu, setup); }) {}

Trainer::Trainer(TrainSetup setup, const TrainDeviceMaker& make_device) {
  CheckOptions(setup.options);
  setup.start.Check("Trainer");
  if (setup.start.size() == 0) throw UsageError("there is no Gaussian to start from");
  state_ = std::make_unique<State>(std::move(setup), make_device);
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
  if (checkpoint.adam.sh_moments() != s.options.sh_moments) {
    throw InputError("the checkpoint's moments of spherical harmonics are not those of --set sh-moments");
  }
  s.sampler.Restore(checkpoint.sampler);
  s.device->RestoreExposures(checkpoint.exposures);
  s.device->RestoreLoss(checkpoint.loss);
  s.device->densifier().Restore(checkpoint.state, n);
  for (const std::shared_ptr<MethodPart>& part : s.parts) part->Restore(checkpoint.state);
  s.iteration = checkpoint.iteration;
  s.model = {};  // first, so that two are never held at once
  s.model = s.device->Upload({checkpoint.gaussians, checkpoint.adam});
  s.seconds = checkpoint.seconds;
  s.run_options = checkpoint.options;
  s.restored = true;
  s.timings = {};
  s.timed_since = s.iteration;
}

void Trainer::Keep(const std::vector<int64_t>& rows) {
  State& s = *state_;
  KeepRows(rows, &s.model.gaussians, &s.model.adam);
  s.device->densifier().Begin(s.model.gaussians.size());
}

double Trainer::Step() {
  state_->Step();
  return state_->device->Loss().last;
}

TrainResult Trainer::Run(const CheckpointPolicy& policy, const Listener& listener, const TrainObserver& observer) {
  try {
    return RunToTheEnd(policy, listener, observer);
  } catch (const Diverged& error) {
    throw Diverged("{}; {}", error.what(), WhatIsSaved(policy.dir));
  }
}

TrainResult Trainer::RunToTheEnd(const CheckpointPolicy& policy, const Listener& listener,
                                 const TrainObserver& observer) {
  State& s = *state_;
  if (s.restored) CheckSameOptions(policy.dir, s.run_options, policy.options);
  s.run_options = policy.options;
  s.timings = {};
  s.timed_since = s.iteration;
  s.ReportLimitations(listener);
  const int64_t total = s.options.iterations;
  const double seconds_before = s.seconds;
  const Stopwatch watch;
  const auto save = [&] {
    s.device->Loss();  // throws before anything that has diverged is written
    CheckFinite(s.model.gaussians, s.iteration);
    WriteCheckpoint(CheckpointPath(policy.dir, s.iteration), MakeCheckpoint());
    RemoveOldCheckpoints(policy.dir, s.iteration);
  };
  const auto loss = [&] { return s.device->Loss().smoothed; };
  const auto show = [&] {
    if (observer) observer({s.iteration, total, s.seconds, s.model.gaussians, loss, s.device->Terms()});
  };
  int64_t reported = s.iteration;
  Stopwatch since_report;
  show();
  while (s.iteration < total) {
    if (InterruptRequested()) {
      if (policy.dir.empty()) throw Interrupted(fmt::format("interrupted at iteration {} of {}", s.iteration, total));
      save();
      throw Interrupted(
          fmt::format("interrupted at iteration {} of {}, saved in {}; run the same command again to "
                      "continue",
                      s.iteration, total, CheckpointPath(policy.dir, s.iteration).string()));
    }
    try {
      s.Step();
    } catch (const OutOfMemory& error) {
      throw OutOfMemory("iteration {} of {}: {}; {}", s.iteration + 1, total, error.what(),
                        WhereToContinue(policy.dir));
    }
    s.seconds = seconds_before + watch.Seconds();
    if (!policy.dir.empty() && policy.every > 0 && s.iteration % policy.every == 0) save();
    show();
    if (s.iteration - reported >= kReportEvery || since_report.Seconds() >= kReportSeconds || s.iteration == total) {
      reported = s.iteration;
      since_report = Stopwatch();
      listener(StepDone{"train", s.iteration, total, "iterations",
                        fmt::format("loss {:.4f}, {} Gaussians", s.device->Loss().smoothed, s.model.gaussians.size())});
    }
  }
  s.device->Loss();  // waits
  CheckFinite(s.model.gaussians, s.iteration);
  s.timings.total = watch.Seconds() * 1000;
  return {s.iteration, s.seconds, s.iteration - s.timed_since, MeanTimings()};
}

const Gaussians& Trainer::gaussians() const { return state_->model.gaussians; }

std::vector<ExposureMap> Trainer::exposures() const { return state_->device->exposures().maps; }

int64_t Trainer::iteration() const { return state_->iteration; }

TrainTimings Trainer::MeanTimings() const { return state_->timings.Mean(state_->iteration - state_->timed_since); }

TrainTimings Trainer::LastTimings() const {
  TrainTimings last = state_->last_timings;
  last.render = state_->device->rasterizer().timings();
  return last;
}

RenderStats Trainer::LastStats() const { return state_->device->rasterizer().stats(); }

Checkpoint Trainer::MakeCheckpoint() const {
  const State& s = *state_;
  Checkpoint checkpoint;
  checkpoint.iteration = s.iteration;
  TrainedModel model = s.device->Download(s.model);
  checkpoint.gaussians = std::move(model.gaussians);
  checkpoint.adam = std::move(model.adam);
  checkpoint.sampler = s.sampler.state();
  checkpoint.exposures = s.device->exposures();
  s.device->densifier().Save(&checkpoint.state);
  checkpoint.seconds = s.seconds;
  checkpoint.loss = s.device->Loss().smoothed;
  checkpoint.options = s.run_options;
  for (const std::shared_ptr<MethodPart>& part : s.parts) part->Save(&checkpoint.state);
  return checkpoint;
}

}  // namespace oraclegs
