#include "oraclegs/pipeline/export.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "oraclegs/core/statistics.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {
namespace {

/// Opacity times the area of the largest face: how much of an image a Gaussian can cover.
float Weight(float opacity, const float* log_scales) {
  const float smallest = std::min({log_scales[0], log_scales[1], log_scales[2]});
  return opacity * std::exp(log_scales[0] + log_scales[1] + log_scales[2] - smallest);
}

}  // namespace

Gaussians Pruned(const Gaussians& gaussians, const ExportOptions& options) {
  gaussians.Check("Pruned");
  const float* logits = gaussians.opacity_logits.data();
  const float* scales = gaussians.log_scales.data();
  std::vector<int64_t> kept;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    if (Sigmoid(logits[i]) >= options.min_opacity) kept.push_back(i);
  }
  const auto limit = static_cast<size_t>(options.max_gaussians);
  if (limit > 0 && kept.size() > limit) {
    std::stable_sort(kept.begin(), kept.end(), [&](int64_t a, int64_t b) {
      return Weight(Sigmoid(logits[a]), scales + 3 * a) > Weight(Sigmoid(logits[b]), scales + 3 * b);
    });
    kept.resize(limit);
    std::sort(kept.begin(), kept.end());
  }
  Gaussians result = gaussians;
  result.ForEach([&](const char*, Buffer<float>& part) {
    const Buffer<float> all = part;
    part = Buffer<float>::Empty(all.shape().WithRows(static_cast<int64_t>(kept.size())));
    const int64_t row = all.shape().row();
    for (size_t i = 0; i < kept.size(); ++i) {
      std::copy_n(all.data() + kept[i] * row, row, part.data() + static_cast<int64_t>(i) * row);
    }
  });
  return result;
}

ExportResult ExportPly(const std::filesystem::path& from, const std::filesystem::path& to,
                       const ExportOptions& options) {
  CheckOptions(options);
  const GaussianPly file = ReadGaussianPly(from);
  const Gaussians kept = Pruned(file.gaussians, options);
  if (kept.size() == 0) {
    throw UsageError("{}: no Gaussian is left of {}; lower --min-opacity", from.string(), file.gaussians.size());
  }
  const int degree = std::min(options.sh_degree, file.sh_degree);
  WriteGaussianPly(to, kept, degree, file.comments);
  return {file.gaussians.size(), kept.size(), degree};
}

}  // namespace oraclegs
