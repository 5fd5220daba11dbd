#include "oraclegs/evaluate/support.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "oraclegs/core/error.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/evaluate/blended_sums.h"
#include "oraclegs/render/constants.h"
#include "oraclegs/render/render.h"

namespace oraclegs {
namespace {

constexpr int64_t kSupportGrain = 1024;   // Gaussians a task
constexpr double kSeenShare = 0.1;        // of a Gaussian's projected area, for a view to see it
constexpr double kFurtherViews = 4;       // unoccluded, for 63 % of the last quarter
constexpr float kTrusted = 0.5f;          // confidence
constexpr double kSmallestFootprint = 1;  // pixels; what is smaller is compared with this

/// Numbers of a view's pixels for BlendedSums: the weight, 1, and 0.
Buffer<float> NumbersOf(const SupportView& view) {
  const int64_t height = view.camera.height, width = view.camera.width;
  if (view.weight.defined()) RequireShape("Support", "weight", view.weight, {height, width});
  if (view.weight_bytes.defined()) RequireShape("Support", "weight", view.weight_bytes, {height, width});
  const Buffer<float> weight = view.weight.defined() ? view.weight.To(kCpu) : Buffer<float>();
  Buffer<float> numbers = Buffer<float>::Zeros({height, width, 3});
  for (int64_t p = 0; p < height * width; ++p) {
    numbers[3 * p] = view.weight_bytes.defined() ? static_cast<float>(view.weight_bytes[p]) / 255
                     : weight.defined()          ? weight[p]
                                                 : 1;
    numbers[3 * p + 1] = 1;
  }
  return numbers;
}

/// Area in pixels that a Gaussian would cover without anything before it, weighted by its alpha: 2 pi opacity sqrt(det
/// of its projected covariance). 0 behind the camera.
double FootprintOf(const GaussianRows& g, const Camera& camera) {
  const Eigen::Matrix3d to_camera = camera.cam_from_world.linear();
  const Eigen::Vector3d p =
      camera.cam_from_world * Eigen::Vector3d(Eigen::Map<const Eigen::Vector3f>(g.means).cast<double>());
  if (!(p.z() > 0)) return 0;
  const Eigen::Quaterniond q(g.quats[0], g.quats[1], g.quats[2], g.quats[3]);
  Eigen::Matrix<double, 2, 3> j;
  j << camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()), 0, camera.fy / p.z(),
      -camera.fy * p.y() / (p.z() * p.z());
  Eigen::Matrix<double, 2, 3> half = j * to_camera * q.normalized().toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis) half.col(axis) *= std::exp(std::min(g.log_scales[axis], 40.f));
  Eigen::Matrix2d covariance = half * half.transpose();
  covariance.diagonal().array() += kLowPass;
  return 2 * std::numbers::pi * Sigmoid(static_cast<double>(g.opacity_logits[0])) *
         std::sqrt(std::max(0.0, covariance.determinant()));
}

/// Evidence of the views for one Gaussian so far.
struct Evidence {
  int images = 0;         ///< number of images that see it
  double seen = 0;        ///< sum of the unoccluded fractions in images that see it
  double confidence = 0;  ///< highest mean confidence in a proposal that sees it
};

float SupportOf(const Evidence& evidence) {
  const double trust = std::clamp(evidence.confidence, 0.0, 1.0);
  if (evidence.images == 0) return static_cast<float>(std::min(trust / 2, 0.4999));
  if (evidence.images == 1) {
    return static_cast<float>(std::min(0.5 + (evidence.seen + trust) / 8, 0.7499));
  }
  return static_cast<float>(1 - 0.25 * std::exp(-std::max(0.0, evidence.seen - 2 * kSeenShare) / kFurtherViews));
}

}  // namespace

std::vector<float> Support(const Gaussians& gaussians, const std::vector<SupportView>& views,
                           const RenderOptions& options) {
  gaussians.Check("Support");
  const int64_t n = gaussians.size();
  std::vector<Evidence> evidence(static_cast<size_t>(n));
  BlendedSums sums(gaussians, options);
  const Gaussians host = gaussians.To(kCpu);
  const GaussianRows rows = host.Rows();
  for (const SupportView& view : views) {
    ThrowIfInterrupted();
    sums.Take(view.camera, NumbersOf(view));
    ParallelBlocks(n, kSupportGrain, [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) {
        const double trusted = sums.Of(i, 0), blended = sums.Of(i, 1);
        if (!(blended > 0)) continue;
        const double share =
            std::min(1.0, blended / std::max(FootprintOf(rows.From(i), view.camera), kSmallestFootprint));
        if (share < kSeenShare) continue;
        Evidence& known = evidence[static_cast<size_t>(i)];
        const double confidence = trusted / blended;
        if (view.is_proposal) {
          known.confidence = std::max(known.confidence, confidence);
        } else if (confidence >= kTrusted) {  // not where the image is masked out
          ++known.images;
          known.seen += share;
        }
      }
    });
  }
  std::vector<float> support(evidence.size());
  std::transform(evidence.begin(), evidence.end(), support.begin(), SupportOf);
  return support;
}

}  // namespace oraclegs
