#include "oraclegs/train/camera_steps.h"

#include <cmath>
#include <numeric>

#include "oraclegs/camera/similarity.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/train/constants.h"

namespace oraclegs {
namespace {

constexpr double kLastRate = 0.01;  // of the first
constexpr double kTurnRate = 4;     // of the rate: about the point in view, a turn moves the picture by parallax alone

/// -rate m / sqrt(v), both without the bias of their start, of all axes. Moments change.
Eigen::Vector3d AdamStepOf(const Eigen::Vector3d& gradient, double rate, int64_t step, Eigen::Vector3d* m,
                           Eigen::Vector3d* v) {
  *m = kAdamBeta1 * *m + (1 - kAdamBeta1) * gradient;
  *v = kAdamBeta2 * *v + (1 - kAdamBeta2) * gradient.cwiseAbs2();
  const double steps = static_cast<double>(step);
  const double m_share = 1 - std::pow(kAdamBeta1, steps), v_share = 1 - std::pow(kAdamBeta2, steps);
  return -rate * (*m / m_share).cwiseQuotient(((*v / v_share).cwiseSqrt().array() + kAdamEpsilon).matrix());
}

/// Distance of what is seen: the harmonic mean over all pixels, weighted by their alpha. 0 where nothing is.
double SeenDistance(const RenderOutput& out) {
  const auto sum = [](const Buffer<float>& plane) {
    const Buffer<float> host = plane.To(kCpu);
    return std::accumulate(host.data(), host.data() + host.count(), 0.0);
  };
  const double inverse = sum(out.inv_depth);
  return inverse > 0 ? sum(out.alpha) / inverse : 0;
}

/// Stops the watch of a rasterizer however a search ends.
class CameraWatch {
 public:
  explicit CameraWatch(Rasterizer* rasterizer) : rasterizer_(rasterizer) { rasterizer_->WatchCamera(true); }
  ~CameraWatch() { rasterizer_->WatchCamera(false); }
  CameraWatch(const CameraWatch&) = delete;
  CameraWatch& operator=(const CameraWatch&) = delete;

 private:
  Rasterizer* rasterizer_;
};

}  // namespace

Eigen::Isometry3d PoseAdam::Step(const Eigen::Isometry3d& cam_from_world, const CameraGradient& gradient,
                                 double distance, double rate) {
  ++step;
  // x -> Exp(turn)(x - pivot) + pivot + shift
  const Eigen::Vector3d pivot(0, 0, distance);
  const Eigen::Vector3d g_turn = gradient.rotation - pivot.cross(gradient.translation);
  const Eigen::Vector3d turn = AdamStepOf(g_turn, kTurnRate * rate, step, &turn_m, &turn_v);
  const Eigen::Vector3d shift = AdamStepOf(gradient.translation, rate * distance, step, &shift_m, &shift_v);
  const Eigen::Isometry3d turned = Nudged(Eigen::Isometry3d::Identity(), turn, Eigen::Vector3d::Zero());
  return Nudged(cam_from_world, turn, pivot - turned * pivot + shift);
}

AlignedCamera AlignCamera(Rasterizer* rasterizer, const Gaussians& gaussians, const TrainView& view,
                          const RenderOptions& render, const CameraAlignOptions& options) {
  const CameraWatch watch(rasterizer);
  const Device device = gaussians.device();
  const Buffer<float> target = view.image.To(kCpu);
  const PixelWeights pixels(view.pixel_weight.To(kCpu), MaskMeaning::kMask);
  PhotometricLoss photometric;
  Gaussians unused = Gaussians::Zeros(gaussians.size(), device);
  PoseAdam adam;
  AlignedCamera best{view.camera, 0, 0};
  Camera camera = view.camera;
  double distance = 0;
  for (int i = 0; i <= options.steps; ++i) {
    const RenderOutput out = rasterizer->Forward(gaussians, camera, render, RenderPass::kTrain);
    Buffer<float> grad = Buffer<float>::Empty({camera.height, camera.width, 3});
    const double loss = photometric(out.image.To(kCpu), target, pixels, {}, &grad).loss;
    if (i == 0) {
      best.loss_before = best.loss = loss;
      distance = SeenDistance(out);
    } else if (loss < best.loss) {
      best.camera = camera, best.loss = loss;
    }
    if (i == options.steps || distance == 0) break;
    rasterizer->Backward(gaussians, {grad.To(device), {}, {}}, &unused);
    const double rate = options.rate * std::pow(kLastRate, static_cast<double>(i) / options.steps);
    camera.cam_from_world = adam.Step(camera.cam_from_world, rasterizer->camera_gradient(), distance, rate);
  }
  return best;
}

}  // namespace oraclegs
