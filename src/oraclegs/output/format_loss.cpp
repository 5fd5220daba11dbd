#include "oraclegs/output/format_loss.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/evaluate/metrics.h"

namespace oraclegs {
namespace {

constexpr int kLossViews = 8, kLossSide = 400;
constexpr float kVisibleLogit = -2;  // opacity 0.12

/// The median place of the visible Gaussians, or of all where none is, and the median distance from it.
Ball MiddleOf(const Gaussians& model) {
  std::vector<int64_t> seen;
  for (int64_t i = 0; i < model.size(); ++i) {
    if (model.opacity_logits[i] > kVisibleLogit) seen.push_back(i);
  }
  const int64_t n = seen.empty() ? model.size() : static_cast<int64_t>(seen.size());
  const auto mean = [&](int64_t k) {
    const int64_t row = seen.empty() ? k : seen[k];
    return Eigen::Map<const Eigen::Vector3f>(model.means.data() + 3 * row);
  };
  Ball middle{Eigen::Vector3d::Zero(), 0};
  std::vector<float> values(static_cast<size_t>(n));
  for (int c = 0; c < 3; ++c) {
    for (int64_t k = 0; k < n; ++k) values[k] = mean(k)[c];
    middle.center[c] = Median(&values);
  }
  std::vector<double> distances(static_cast<size_t>(n));  // finite for all floats
  for (int64_t k = 0; k < n; ++k) distances[k] = (mean(k).cast<double>() - middle.center).norm();
  middle.radius = Median(&distances);
  if (middle.radius > 0) return middle;
  middle.radius = 3 * std::exp(model.log_scales[0]);  // all at one place
  return middle;
}

/// Cameras on a circle, in turn a little above and below its plane; up is where y falls.
std::vector<Camera> CamerasAround(const Ball& middle) {
  std::vector<Camera> cameras;
  for (int i = 0; i < kLossViews; ++i) {
    const double turn = 2 * std::numbers::pi * i / kLossViews, rise = i % 2 == 0 ? 0.3 : -0.3;
    const Eigen::Vector3d way(std::cos(turn) * std::cos(rise), -std::sin(rise), std::sin(turn) * std::cos(rise));
    Camera camera;
    camera.width = camera.height = kLossSide;
    camera.fx = camera.fy = kLossSide / 2. * std::numbers::sqrt3;  // 60 degrees
    camera.cx = camera.cy = kLossSide / 2.;
    camera.cam_from_world = LookAt(middle.center + 2 * middle.radius * way, middle.center, -Eigen::Vector3d::UnitY());
    cameras.push_back(camera);
  }
  return cameras;
}

}  // namespace

double PsnrFromAround(const Gaussians& splat, const Gaussians& model, const RenderOptions& options) {
  const std::unique_ptr<Rasterizer> rasterizer = MakeRasterizer(kCpu);
  const auto render = [&](const Gaussians& gaussians, const Camera& camera) {
    Buffer<float> image = rasterizer->Forward(gaussians, camera, options, RenderPass::kInference).image.Clone();
    for (int64_t i = 0; i < image.count(); ++i) image[i] = std::clamp(image[i], 0.f, 1.f);
    return image;
  };
  double squares = 0;  // mean over the views
  for (const Camera& camera : CamerasAround(MiddleOf(model))) {
    const double psnr = Psnr(render(splat, camera), render(model, camera));
    squares += std::pow(10., -psnr / 10) / kLossViews;
  }
  return -10 * std::log10(squares);
}

double LossOfScore(double score, double psnr) { return 10 * std::log10(1 + std::pow(10., (score - psnr) / 10)); }

}  // namespace oraclegs
