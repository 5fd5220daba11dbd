#pragma once
// Seeded scenes for the rasterizer's tests and benchmarks.

#include "oraclegs/core/rng.h"
#include "oraclegs/render/render.h"
#include "support/buffers.h"

namespace oraclegs {

inline Camera FrontCamera(int width, int height) {
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = 0.9 * width, camera.fy = 0.92 * width;
  camera.cx = 0.5 * width - 1.3, camera.cy = 0.5 * height + 0.7;  // off center, so that a swap shows
  return camera;
}

/// n Gaussians in front of FrontCamera: world scales around `scale`, opacities over the whole range, all SH filled.
inline Gaussians RandomGaussians(int64_t n, double scale, uint64_t seed) {
  Rng rng(seed, RandomStream::kInitialPoints);
  Gaussians g = Gaussians::Empty(n);
  float *mean = g.means.data(), *log_scale = g.log_scales.data();
  float *quat = g.quats.data(), *logit = g.opacity_logits.data(), *sh = g.sh.data();
  for (int64_t i = 0; i < n; ++i) {
    const double z = rng.Uniform(1.5, 6);
    mean[3 * i] = static_cast<float>(rng.Uniform(-0.7, 0.7) * z);
    mean[3 * i + 1] = static_cast<float>(rng.Uniform(-0.6, 0.6) * z);
    mean[3 * i + 2] = static_cast<float>(z);
    for (int k = 0; k < 3; ++k) log_scale[3 * i + k] = static_cast<float>(std::log(scale) + rng.Uniform(-1.2, 0.8));
    for (int k = 0; k < 4; ++k) quat[4 * i + k] = static_cast<float>(rng.Uniform(-1, 1));
    logit[i] = static_cast<float>(rng.Uniform(-4, 4));
    for (int k = 0; k < 48; ++k) sh[48 * i + k] = static_cast<float>(rng.Uniform(-1, 1) * (k < 3 ? 1.2 : 0.25));
  }
  return g;
}

/// dL/d(output), standard normal.
inline RenderGrads RandomUpstream(const Camera& camera, uint64_t seed) {
  const int64_t h = camera.height, w = camera.width;
  return {RandomNormal({h, w, 3}, seed), RandomNormal({h, w}, seed + 1), RandomNormal({h, w}, seed + 2)};
}

}  // namespace oraclegs
