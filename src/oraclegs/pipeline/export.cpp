#include "oraclegs/pipeline/export.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "oraclegs/gaussians/ply.h"

namespace oraclegs {
namespace {

float Opacity(float logit) { return 1 / (1 + std::exp(-logit)); }

/// Opacity times the area of the largest face: how much of a picture a Gaussian can cover.
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
    if (Opacity(logits[i]) >= options.min_opacity) kept.push_back(i);
  }
  const auto limit = static_cast<size_t>(options.max_gaussians);
  if (limit > 0 && kept.size() > limit) {
    std::stable_sort(kept.begin(), kept.end(), [&](int64_t a, int64_t b) {
      return Weight(Opacity(logits[a]), scales + 3 * a) > Weight(Opacity(logits[b]), scales + 3 * b);
    });
    kept.resize(limit);
    std::sort(kept.begin(), kept.end());
  }
  const Buffer<float> rows = torch::tensor(kept, torch::kLong);
  Gaussians result = gaussians;
  result.ForEach([&](const char*, Buffer<float>& t) { t = t.index_select(0, rows); });
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
