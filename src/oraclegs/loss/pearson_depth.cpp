#include "oraclegs/loss/depth_losses.h"

#include <cmath>
#include <optional>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kPearsonRows = 16;  // of pixels a task

// Relative variance below which values are constant up to the rounding of float32.
constexpr double kMinRelativeVariance = 1e-12;

/// Weighted sums over pixels of pairs (a, b), or of their differences from the means.
struct PairSums {
  double weight = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void Add(double w, double x, double y) {
    weight += w;
    a += w * x;
    b += w * y;
    aa += w * x * x;
    bb += w * y * y;
    ab += w * x * y;
  }
  void Add(const PairSums& other) {
    weight += other.weight;
    a += other.a;
    b += other.b;
    aa += other.aa;
    bb += other.bb;
    ab += other.ab;
  }
};

/// Sums over a patch; blocks of rows of fixed size are added in order.
PairSums SumPatch(const DepthImages& images, const ImagePatch& patch, double mean_a, double mean_b) {
  std::vector<PairSums> parts(static_cast<size_t>((patch.height + kPearsonRows - 1) / kPearsonRows));
  const float *a = images.rendered.data(), *b = images.target.data();
  ParallelBlocks(patch.height, kPearsonRows, [&](int64_t begin, int64_t end) {
    PairSums sums;
    for (int64_t y = patch.y + begin; y < patch.y + end; ++y) {
      for (int64_t i = y * images.width() + patch.x; i < y * images.width() + patch.x + patch.width; ++i) {
        const double w = images.MaskAt(i);
        if (w > 0) sums.Add(w, static_cast<double>(a[i]) - mean_a, static_cast<double>(b[i]) - mean_b);
      }
    }
    parts[static_cast<size_t>(begin / kPearsonRows)] = sums;
  });
  PairSums total;
  for (const PairSums& part : parts) total.Add(part);
  return total;
}

/// Correlation of one patch: d(1 - r)/d(a_i) = w_i (to_a (a_i - mean_a) - to_b (b_i - mean_b)).
struct Correlation {
  double r = 0;
  double mean_a = 0, mean_b = 0;
  double to_a = 0, to_b = 0;
};

std::optional<Correlation> Correlate(const DepthImages& images, const ImagePatch& patch) {
  const PairSums raw = SumPatch(images, patch, 0, 0);
  if (!(raw.weight >= 2)) return std::nullopt;
  Correlation c;
  c.mean_a = raw.a / raw.weight;
  c.mean_b = raw.b / raw.weight;
  const PairSums central = SumPatch(images, patch, c.mean_a, c.mean_b);
  if (!(central.aa > kMinRelativeVariance * raw.aa && central.bb > kMinRelativeVariance * raw.bb)) return std::nullopt;
  const double scale = std::sqrt(central.aa) * std::sqrt(central.bb);
  c.r = central.ab / scale;
  c.to_a = c.r / central.aa;
  c.to_b = 1 / scale;
  return c;
}

void AddCorrelationGradient(const DepthImages& images, const ImagePatch& patch, const Correlation& c, double weight,
                            float* grad) {
  const float *a = images.rendered.data(), *b = images.target.data();
  ParallelBlocks(patch.height, kPearsonRows, [&](int64_t begin, int64_t end) {
    for (int64_t y = patch.y + begin; y < patch.y + end; ++y) {
      for (int64_t i = y * images.width() + patch.x; i < y * images.width() + patch.x + patch.width; ++i) {
        const double w = images.MaskAt(i);
        if (!(w > 0)) continue;
        const double da = static_cast<double>(a[i]) - c.mean_a, db = static_cast<double>(b[i]) - c.mean_b;
        grad[i] += static_cast<float>(weight * w * (c.to_a * da - c.to_b * db));
      }
    }
  });
}

void CheckPatches(const DepthImages& images, const std::vector<ImagePatch>& patches) {
  for (const ImagePatch& p : patches) {
    if (p.x < 0 || p.y < 0 || p.width < 1 || p.height < 1 || p.x + p.width > images.width() ||
        p.y + p.height > images.height()) {
      throw ShapeError("PatchPearsonDepthLoss: the patch of {} x {} at ({}, {}) leaves the image of {} x {}", p.width,
                       p.height, p.x, p.y, images.width(), images.height());
    }
  }
}

}  // namespace

double PatchPearsonDepthLoss(const DepthImages& images, const std::vector<ImagePatch>& patches, double weight,
                             Buffer<float>* grad) {
  images.Check("PearsonDepthLoss", grad);
  CheckPatches(images, patches);
  std::vector<std::optional<Correlation>> correlations;
  double sum = 0;
  int64_t count = 0;
  for (const ImagePatch& patch : patches) {
    correlations.push_back(Correlate(images, patch));
    if (!correlations.back()) continue;
    sum += 1 - correlations.back()->r;
    ++count;
  }
  if (grad != nullptr && grad->defined()) {
    grad->SetZero();
    // Sequential, since patches may overlap.
    for (size_t k = 0; k < patches.size(); ++k) {
      if (!correlations[k]) continue;
      AddCorrelationGradient(images, patches[k], *correlations[k], weight / static_cast<double>(count), grad->data());
    }
  }
  return count == 0 ? 0 : weight * sum / static_cast<double>(count);
}

double PearsonDepthLoss(const DepthImages& images, double weight, Buffer<float>* grad) {
  images.Check("PearsonDepthLoss", grad);
  return PatchPearsonDepthLoss(images, {{0, 0, images.width(), images.height()}}, weight, grad);
}

}  // namespace oraclegs
