#include "oraclegs/run/time_estimate.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/train/timings.h"
#include "oraclegs/train/trainer.h"

namespace oraclegs {
namespace {

// Bytes.
constexpr double kProgramBytes = 150e6, kBytesOfGaussian = 1100, kBytesOfViewPixel = 34, kBytesOfProposalPixel = 24,
                 kBytesOfWorkPixel = 170, kBytesOfLoadedPixel = 44;

constexpr int kSide = 256, kGaussians = 20000;
constexpr int kWarmUps = 2, kSteps = 21;
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
  std::vector<double> milliseconds;
  for (int i = 0; i < kWarmUps + kSteps; ++i) {
    const Stopwatch watch;
    trainer->Step();
    if (i >= kWarmUps) milliseconds.push_back(1e3 * watch.Seconds());
  }
  // Not the best: other work on the machine slows the run, too. Not the mean: a moment's stall does not.
  return UpperMedian(std::move(milliseconds)) / kReferenceMilliseconds;
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

}  // namespace oraclegs
