#include "oraclegs/loss/depth_losses.h"

#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr double kMinRelativeSquares = 1e-12;  // less is the rounding of float32
constexpr double kSmoothing = 0.01;            // of the deviation over all patches, added to what a patch is divided by

/// Calls f(pixel, mask) for the pixels of a patch with a mask above 0.
template <class F>
void ForCounted(const DepthImages& images, const ImagePatch& patch, F&& f) {
  for (int64_t y = patch.y; y < patch.y + patch.height; ++y) {
    for (int64_t i = y * images.width() + patch.x; i < y * images.width() + patch.x + patch.width; ++i) {
      const double w = images.MaskAt(i);
      if (w > 0) f(i, w);
    }
  }
}

struct WeightedMoments {
  double weight = 0, mean = 0;
  double squares = 0;  ///< weighted sum of squared differences from the mean

  /// Standard deviation with n - 1; 0 where it is rounding only.
  double Deviation() const {
    return weight > 1 && squares > kMinRelativeSquares * weight * mean * mean ? std::sqrt(squares / (weight - 1)) : 0;
  }
};

WeightedMoments MomentsOf(const DepthImages& images, const Buffer<float>& values, const ImagePatch& patch) {
  WeightedMoments moments;
  double sum = 0;
  ForCounted(images, patch, [&](int64_t i, double w) {
    moments.weight += w;
    sum += w * static_cast<double>(values[i]);
  });
  if (!(moments.weight > 0)) return moments;
  moments.mean = sum / moments.weight;
  ForCounted(images, patch, [&](int64_t i, double w) {
    const double d = static_cast<double>(values[i]) - moments.mean;
    moments.squares += w * d * d;
  });
  return moments;
}

/// Moments of the union of two disjoint sets.
WeightedMoments Joined(const WeightedMoments& a, const WeightedMoments& b) {
  if (!(b.weight > 0)) return a;
  const double weight = a.weight + b.weight, apart = b.mean - a.mean;
  return {weight, a.mean + apart * b.weight / weight,
          a.squares + b.squares + apart * apart * a.weight * b.weight / weight};
}

/// One image with the statistics of its patches.
struct NormalizedImage {
  const Buffer<float>* values;
  std::vector<WeightedMoments> patches;
  WeightedMoments all;           ///< over the used patches
  std::vector<double> divisors;  ///< divisor of each patch; 0 = unused

  double At(size_t patch, int64_t pixel) const {
    return (static_cast<double>((*values)[pixel]) - patches[patch].mean) / divisors[patch];
  }
};

NormalizedImage Normalize(const DepthImages& images, const Buffer<float>& values,
                          const std::vector<ImagePatch>& patches, DepthNormalization normalization) {
  NormalizedImage out{
      &values, std::vector<WeightedMoments>(patches.size()), {}, std::vector<double>(patches.size(), 0.0)};
  ParallelFor(static_cast<int64_t>(patches.size()),
              [&](int64_t k) { out.patches[k] = MomentsOf(images, values, patches[k]); });
  for (const WeightedMoments& patch : out.patches) {
    if (patch.weight >= 2) out.all = Joined(out.all, patch);
  }
  const bool local = normalization == DepthNormalization::kLocal;
  const double whole = local ? 0 : MomentsOf(images, values, {0, 0, images.width(), images.height()}).Deviation();
  for (size_t k = 0; k < patches.size(); ++k) {
    if (!(out.patches[k].weight >= 2)) continue;
    out.divisors[k] = (local ? out.patches[k].Deviation() : whole) + kSmoothing * out.all.Deviation();
  }
  return out;
}

/// Contribution of one patch to the loss and to the derivatives of its own mean and deviation.
struct PatchErrors {
  double squares = 0, weight = 0;  ///< over the pixels beyond the tolerance
  double sum = 0;                  ///< sum of the errors
  double with_value = 0;           ///< sum of error times normalized rendered value
};

/// Rendered image and target, normalized by patches.
struct NormalizedPair {
  const DepthImages& images;
  const std::vector<ImagePatch>& patches;
  double tolerance;
  NormalizedImage rendered, target;

  bool Counts(size_t patch) const { return rendered.divisors[patch] > 0 && target.divisors[patch] > 0; }

  /// Calls f(pixel, mask, normalized rendered value, error) for each pixel with a mask above 0; the error is 0 within
  /// the tolerance.
  template <class F>
  void ForErrors(size_t patch, F&& f) const {
    ForCounted(images, patches[patch], [&](int64_t i, double w) {
      const double x = rendered.At(patch, i), error = x - target.At(patch, i);
      f(i, w, x, std::abs(error) > tolerance ? error : 0);
    });
  }
};

}  // namespace

int64_t DrawPatchSide(const PatchSideRange& range, DepthNormalization normalization, uint64_t seed, int64_t iteration) {
  // Offset past the draws of RandomPatches, which begin at the same multiple of 2^32.
  const uint64_t own = (uint64_t{1} << 31) + (normalization == DepthNormalization::kGlobal ? 1 : 0);
  Rng rng(seed, RandomStream::kDepthPatches, (static_cast<uint64_t>(iteration) << 32) + own);
  return range.min + rng.Index(range.max - range.min + 1);
}

double NormalizedDepthLoss(const DepthImages& images, const NormalizedDepthOptions& options, double weight,
                           Buffer<float>* grad) {
  images.Check("NormalizedDepthLoss", grad);
  float* g = grad != nullptr && grad->defined() ? grad->data() : nullptr;
  if (g != nullptr) grad->SetZero();
  const std::vector<ImagePatch> patches = GridPatches(images.height(), images.width(), options.patch_side);
  const NormalizedPair pair = {images, patches, options.tolerance,
                               Normalize(images, images.rendered, patches, options.normalization),
                               Normalize(images, images.target, patches, options.normalization)};
  std::vector<PatchErrors> errors(patches.size());
  ParallelFor(static_cast<int64_t>(patches.size()), [&](int64_t task) {
    const auto k = static_cast<size_t>(task);
    if (!pair.Counts(k)) return;
    PatchErrors& e = errors[k];
    pair.ForErrors(k, [&](int64_t, double w, double x, double error) {
      e.squares += w * error * error;
      e.weight += error == 0 ? 0 : w;
      e.sum += w * error;
      e.with_value += w * error * x;
    });
  });
  double squares = 0, counted = 0, through_all = 0;
  for (size_t k = 0; k < patches.size(); ++k) {
    if (!pair.Counts(k)) continue;
    squares += errors[k].squares;
    counted += errors[k].weight;
    through_all += errors[k].with_value / pair.rendered.divisors[k];
  }
  if (!(counted > 0)) return 0;
  if (g == nullptr) return weight * squares / counted;

  const NormalizedImage& rendered = pair.rendered;
  const double scale = 2 * weight / counted;
  const double all_deviation = rendered.all.Deviation();
  const double to_all = all_deviation > 0 ? through_all * kSmoothing / ((rendered.all.weight - 1) * all_deviation) : 0;
  ParallelFor(static_cast<int64_t>(patches.size()), [&](int64_t task) {
    const auto k = static_cast<size_t>(task);
    if (!pair.Counts(k)) return;
    const WeightedMoments& patch = rendered.patches[k];
    const double d = rendered.divisors[k], deviation = patch.Deviation();
    const bool through_own = options.normalization == DepthNormalization::kLocal && deviation > 0;
    const double to_own = through_own ? errors[k].with_value / (d * (patch.weight - 1) * deviation) : 0;
    const double to_mean = errors[k].sum / (patch.weight * d);
    pair.ForErrors(k, [&](int64_t i, double w, double, double error) {
      const double value = static_cast<double>(images.rendered[i]);
      const double slope = error / d - to_mean - to_own * (value - patch.mean) - to_all * (value - rendered.all.mean);
      g[i] = static_cast<float>(scale * w * slope);
    });
  });
  return weight * squares / counted;
}

}  // namespace oraclegs
