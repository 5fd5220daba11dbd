// Trains a few Gaussians on images of others, through the installed headers alone. Prints the error before and after;
// ends with 1 unless training lowers it.

#include <cmath>
#include <cstdio>
#include <vector>

#include "oraclegs/render/render.h"
#include "oraclegs/train/trainer.h"

namespace {

using oraclegs::Camera;
using oraclegs::Gaussians;

constexpr int kWidth = 48, kHeight = 36, kSide = 4;

/// A grid of blobs in front of the cameras, of one color or of many.
Gaussians Blobs(bool colored) {
  Gaussians blobs = Gaussians::Zeros(kSide * kSide);
  for (int i = 0; i < kSide * kSide; ++i) {
    float* mean = blobs.means.data() + 3 * i;
    mean[0] = 0.5f * static_cast<float>(i % kSide) - 0.75f;
    mean[1] = 0.5f * static_cast<float>(i / kSide) - 0.75f;
    for (int axis = 0; axis < 3; ++axis) blobs.log_scales.data()[3 * i + axis] = std::log(0.2f);
    blobs.quats.data()[4 * i] = 1;
    blobs.opacity_logits.data()[i] = 1;
    float* base_color = blobs.sh.data() + static_cast<long>(i) * oraclegs::kShFloats;
    for (int channel = 0; channel < 3; ++channel) {
      base_color[channel] = colored ? std::sin(static_cast<float>(3 * i + channel)) : 0.0f;
    }
  }
  return blobs;
}

Camera CameraAt(double x) {
  Camera camera{kWidth, kHeight, 40, 40, kWidth / 2.0, kHeight / 2.0};
  camera.cam_from_world.translation() = Eigen::Vector3d(-x, 0, 3);
  return camera;
}

double MeanError(const Gaussians& gaussians, const oraclegs::TrainView& view) {
  const auto image = oraclegs::MakeRasterizer(oraclegs::kCpu)
                         ->Forward(gaussians, view.camera, {}, oraclegs::RenderPass::kInference)
                         .image.Clone();
  double sum = 0;
  for (int64_t i = 0; i < image.count(); ++i) sum += std::abs(image.data()[i] - view.image.data()[i]);
  return sum / static_cast<double>(image.count());
}

}  // namespace

int main() {
  const Gaussians truth = Blobs(true);
  const auto rasterizer = oraclegs::MakeRasterizer(oraclegs::kCpu);
  oraclegs::TrainingData data;
  for (const double x : {-0.5, 0.0, 0.5}) {
    oraclegs::TrainView view{"view", CameraAt(x), {}, {}};
    view.image = rasterizer->Forward(truth, view.camera, {}, oraclegs::RenderPass::kInference).image.Clone();
    data.photos.push_back(view);
  }
  const oraclegs::TrainView held = data.photos[1];

  oraclegs::TrainOptions options;
  options.iterations = 200;
  options.max_gaussians = truth.size();
  const double before = MeanError(Blobs(false), held);
  oraclegs::Trainer trainer(options, /*seed=*/1, {0, 0, 0}, data, Blobs(false));
  for (int i = 0; i < options.iterations; ++i) trainer.Step();
  const double after = MeanError(trainer.gaussians(), held);
  std::printf("mean error %.4f before, %.4f after %ld iterations\n", before, after,
              static_cast<long>(trainer.iteration()));
  return after < 0.5 * before ? 0 : 1;
}
