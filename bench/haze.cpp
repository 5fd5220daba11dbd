#include "bench/haze.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/render/recolor.h"

namespace oraclegs {
namespace {

// A pixel is linear in the colors, so that in colors that are 1 nearer than t and 0 beyond, it is the blending weight
// that lies nearer than t. A render has three channels for three such t. They stand 1 % apart, and a pixel takes the
// next one on the far side of its limit: what counts as haze is at least 2 % off the truth, and of what is between 2
// and 3 % off a part is missed.
constexpr double kStep = 1.01;
constexpr double kNearer = 0.98, kFarther = 1.02;
constexpr float kShown = 1.f / 255;  // alpha of a pixel that shows something

/// Depths along the optical axis of a camera.
std::vector<float> DepthsOf(const Gaussians& gaussians, const Camera& camera) {
  std::vector<float> depths(static_cast<size_t>(gaussians.size()));
  const Eigen::Vector3f axis = camera.Forward().cast<float>();
  const auto offset = static_cast<float>(camera.cam_from_world.translation().z());
  for (size_t i = 0; i < depths.size(); ++i) {
    depths[i] = axis.dot(Eigen::Map<const Eigen::Vector3f>(gaussians.means.data() + 3 * i)) + offset;
  }
  return depths;
}

}  // namespace

Haze HazeOf(const Gaussians& gaussians, const Camera& camera, const std::vector<float>& depth, RenderOptions options) {
  Haze haze;
  float nearest = 0, farthest = 0;
  for (const float z : depth) {
    if (z <= 0) continue;
    nearest = nearest > 0 ? std::min(nearest, z) : z;
    farthest = std::max(farthest, z);
  }
  if (farthest <= 0) return haze;
  const double first = kNearer * nearest / kStep;
  const auto steps_to = [&](float z, double limit) { return std::log(limit * z / first) / std::log(kStep); };
  const int thresholds = 1 + static_cast<int>(std::ceil(steps_to(farthest, kFarther)));

  options.background = {0, 0, 0};
  options.sh_degree = 0;
  const auto rasterizer = MakeRasterizer(gaussians.device());
  const std::vector<float> depths = DepthsOf(gaussians, camera);
  Buffer<float> colors = Buffer<float>::Empty({gaussians.size(), 3});
  for (int k = 0; k < thresholds; k += 3) {
    for (int c = 0; c < 3; ++c) {
      const auto threshold = static_cast<float>(first * std::pow(kStep, k + c));
      for (size_t i = 0; i < depths.size(); ++i) {
        colors[static_cast<int64_t>(3 * i) + c] = depths[i] < threshold ? 1.f : 0.f;
      }
    }
    const RenderOutput render =
        rasterizer->Forward(Recolored(gaussians, colors), camera, options, RenderPass::kInference);
    for (size_t p = 0; p < depth.size(); ++p) {
      const auto at = static_cast<int64_t>(p);
      const float alpha = render.alpha[at];
      if (depth[p] <= 0 || alpha < kShown) continue;
      haze.pixels += k == 0 ? 1 : 0;
      const int before = static_cast<int>(std::floor(steps_to(depth[p], kNearer))) - k;
      const int behind = static_cast<int>(std::ceil(steps_to(depth[p], kFarther))) - k;
      if (before >= 0 && before < 3) haze.before += render.image[3 * at + before] / alpha;
      if (behind >= 0 && behind < 3) haze.behind += 1 - render.image[3 * at + behind] / alpha;
    }
  }
  return haze;
}

}  // namespace oraclegs
