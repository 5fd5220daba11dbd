#include "oraclegs/run/time_estimate.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/host.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/core/text.h"
#include "oraclegs/run/needed_photos.h"
#include "oraclegs/train/timings.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {
namespace {

// Bytes.
constexpr double kProgramBytes = 150e6, kBytesOfGaussian = 1100, kBytesOfViewPixel = 34, kBytesOfProposalPixel = 24,
                 kBytesOfWorkPixel = 170, kBytesOfLoadedPixel = 44;

constexpr int kSide = 256, kGaussians = 20000;
constexpr int kWarmUps = 2, kSteps = 10;
constexpr double kReferenceMilliseconds = 7.4;  // time of a step on the reference machine

/// A square in front of the camera, filled with small Gaussians.
Gaussians Cloud() {
  Gaussians gaussians = Gaussians::Zeros(kGaussians);
  Rng rng(1, RandomStream::kInitialPoints);
  for (int64_t i = 0; i < kGaussians; ++i) {
    gaussians.means[3 * i] = static_cast<float>(2 * rng.Uniform() - 1);
    gaussians.means[3 * i + 1] = static_cast<float>(2 * rng.Uniform() - 1);
    gaussians.means[3 * i + 2] = static_cast<float>(2 + rng.Uniform());
    for (int k = 0; k < 3; ++k) gaussians.log_scales[3 * i + k] = std::log(0.02f);
    gaussians.quats[4 * i] = 1;
  }
  return gaussians;
}

std::unique_ptr<Trainer> MakeProbe() {
  TrainOptions options;
  options.max_gaussians = kGaussians;
  options.sh_degree_interval = 1;
  Camera camera;
  camera.width = camera.height = kSide;
  camera.fx = camera.fy = kSide;
  camera.cx = camera.cy = 0.5 * kSide;
  TrainView view{"probe", camera, Buffer<float>::Empty({kSide, kSide, 3}), {}};
  std::fill_n(view.image.data(), view.image.count(), 0.5f);
  return std::make_unique<Trainer>(options, 0, std::array<float, 3>{}, TrainingData({std::move(view)}), Cloud());
}

double Measure() {
  const auto trainer = MakeProbe();
  double mean = 0;
  for (int i = 0; i < kWarmUps + kSteps; ++i) {
    const Stopwatch watch;
    trainer->Step();
    const double milliseconds = 1e3 * watch.Seconds();
    // The mean, not the best: other work on the machine slows the run, too.
    if (i >= kWarmUps) mean += milliseconds / kSteps;
  }
  return mean / kReferenceMilliseconds;
}

constexpr double kCoveredByObject = 0.45;  // of a Blender scene's images

/// Warns only: the estimate is an upper bound, and more memory may become free.
void WarnOfMemory(int64_t needed, const Listener& listener) {
  const uint64_t available = AvailableMemory();
  if (available == 0 || static_cast<uint64_t>(needed) <= available) return;
  listener(Warning{fmt::format(
      "this run may need {:.1f} GB of memory, {:.1f} GB are available; close other programs, or lower --max-size or "
      "--max-gaussians",
      Gigabytes(needed), Gigabytes(static_cast<int64_t>(available)))});
}

}  // namespace

double EstimateSeconds(const Stage& stage, const EstimateInput& input) {
  return stage.work.seconds != nullptr ? input.slowness * stage.work.seconds(input) : 0;
}

int64_t EstimateRunMemory(const EstimateInput& input) {
  const double pixels = PixelsOfView(input);
  const double held =
      kBytesOfViewPixel * pixels * input.scene.views + kBytesOfProposalPixel * pixels * ProposalsOf(input);
  const double loading = kBytesOfLoadedPixel * FullPixels(input) * std::min(NumThreads(), input.scene.views);
  const double training = kBytesOfGaussian * input.options.train.max_gaussians.value() + kBytesOfWorkPixel * pixels;
  return static_cast<int64_t>(kProgramBytes + held + std::max(loading, training));
}

double CpuSlowness() {
  static const double slowness = Measure();
  return slowness;
}

void AnnounceStages(Run* run) {
  const Split split = SplitOfRun(*run);
  const auto train = static_cast<int>(split.train.size()), test = static_cast<int>(split.test.size());
  const auto all = static_cast<int>(run->scene.views.size());
  const EstimateInput input{run->options,
                            SizeOf(run->scene, train),
                            run->photos.empty() ? 0 : all,
                            test,
                            all - train - test,
                            run->plan.device.is_cpu() ? CpuSlowness() : 0,
                            run->scene.format == SceneFormat::kBlender ? kCoveredByObject : 1};
  RunPlanned planned;
  for (const Stage& stage : *run->stages) {
    if (!stage.work.wanted(*run)) continue;
    const bool known = run->plan.device.is_cpu() && !(stage.work.uses_network && stage.work.uses_network(*run));
    planned.stages.push_back({stage.name, known ? EstimateSeconds(stage, input) : 0});
    if (known) run->predicted[stage.name] = planned.stages.back().seconds;
  }
  run->listener(planned);
  if (run->plan.device.is_cpu()) WarnOfMemory(EstimateRunMemory(input), run->listener);
}

}  // namespace oraclegs
