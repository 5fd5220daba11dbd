#pragma once
// A slow reference renderer: double precision, one pixel after another, every Gaussian tried on every pixel,
// straight from docs/method.md#projection to #spherical-harmonics. No tiles, no bounds, no tricks. The per-Gaussian
// mathematics is the shared header.

#include <algorithm>
#include <vector>

#include "oraclegs/render/render.h"
#include "oraclegs/render/splat_math-inl.h"

namespace oraclegs {

struct ReferenceImage {
  std::vector<double> image, alpha, inv_depth;  ///< [H*W*3], [H*W], [H*W]
};

/// A scene in double, so that finite differences have digits to spare.
struct ReferenceScene {
  std::vector<double> means, log_scales, quats, opacity_logits, sh;
  Camera camera;
  RenderOptions options;

  static std::vector<double> Values(const Buffer<float>& t) { return {t.data(), t.data() + t.count()}; }
  ReferenceScene(const Gaussians& g, const Camera& camera, const RenderOptions& options)
      : means(Values(g.means)),
        log_scales(Values(g.log_scales)),
        quats(Values(g.quats)),
        opacity_logits(Values(g.opacity_logits)),
        sh(Values(g.sh)),
        camera(camera),
        options(options) {}
  int64_t size() const { return static_cast<int64_t>(opacity_logits.size()); }

  /// The sum of upstream times output.
  double Loss(const RenderGrads& upstream) const {
    const ReferenceImage out = Render();
    double sum = 0;
    for (size_t i = 0; i < out.image.size(); ++i) sum += upstream.image.data()[i] * out.image[i];
    for (size_t i = 0; i < out.alpha.size(); ++i) {
      sum += upstream.alpha.data()[i] * out.alpha[i] + upstream.inv_depth.data()[i] * out.inv_depth[i];
    }
    return sum;
  }

  ReferenceImage Render() const {
    namespace math = HWY_NAMESPACE;
    const SplatCamera<double> cam = MakeSplatCamera<double>(camera, options);
    const Eigen::Vector3d eye = camera.Center();

    struct Item {
      math::ProjectedSplat<double> p;
      double color[3];
    };
    std::vector<Item> items;
    for (int64_t i = 0; i < size(); ++i) {
      const double *m = &means[3 * i], *s = &log_scales[3 * i], *q = &quats[4 * i];
      const math::RawSplat<double> raw{{m[0], m[1], m[2]}, {s[0], s[1], s[2]}, q[0], q[1], q[2], q[3],
                                       opacity_logits[i]};
      Item item{math::Project(math::EvaluateChain(raw, cam), cam), {}};
      if (options.opacity_factors.defined()) {
        item.p.opacity *= static_cast<double>(options.opacity_factors.data()[i]);
      }
      if (item.p.z <= kNearPlane) continue;
      math::Vec3<double> d{m[0] - eye[0], m[1] - eye[1], m[2] - eye[2]};
      const double norm = std::sqrt(math::Dot(d, d));
      d = {d.x / norm, d.y / norm, d.z / norm};
      double basis[16];
      math::ShBasis(options.sh_degree, d, basis);
      for (int c = 0; c < 3; ++c) {
        double value = 0.5;
        for (int k = 0; k < ShCount(options.sh_degree); ++k) value += basis[k] * sh[48 * i + 3 * k + c];
        item.color[c] = std::max(value, 0.0);
      }
      items.push_back(item);
    }
    std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.p.z < b.p.z; });

    ReferenceImage out;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        double t = 1, c[3] = {}, inv_depth = 0;
        for (const Item& item : items) {
          const double dx = item.p.mx - (x + 0.5), dy = item.p.my - (y + 0.5);
          const double power = -0.5 * (item.p.conic_a * dx * dx + item.p.conic_c * dy * dy) - item.p.conic_b * dx * dy;
          // The float32 cap: two in a row leave less than 1e-4, in double exactly 1e-4 and a coin flip
          // (docs/method.md#blending).
          const double alpha = std::min(static_cast<double>(0.99f), item.p.opacity * std::exp(power));
          if (power > 0 || alpha < 1.0 / 255) continue;
          const double next = t * (1 - alpha);
          if (next < 1e-4) break;
          for (int k = 0; k < 3; ++k) c[k] += alpha * t * item.color[k];
          inv_depth += alpha * t / item.p.z;
          t = next;
        }
        for (int k = 0; k < 3; ++k) out.image.push_back(c[k] + t * options.background[k]);
        out.alpha.push_back(1 - t);
        out.inv_depth.push_back(inv_depth);
      }
    }
    return out;
  }
};

}  // namespace oraclegs
