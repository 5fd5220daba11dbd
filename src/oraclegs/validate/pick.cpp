#include "oraclegs/validate/pick.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "oraclegs/core/error.h"
#include "oraclegs/image/similarity.h"

namespace oraclegs {
namespace {

constexpr float kMinConfidence = 0.02f, kMaxConfidence = 0.98f;  // limits beyond which a weight no longer changes
constexpr float kSensorNoise = 1e-4f;                            // smallest variance of an image's error

void CheckSizes(const std::vector<Proposal>& candidates, const std::vector<ConfidenceMap>& confidence) {
  if (candidates.empty() || candidates.size() != confidence.size()) {
    throw ShapeError("Pick: {} candidates with {} confidence maps", candidates.size(), confidence.size());
  }
  for (size_t c = 0; c < candidates.size(); ++c) {
    if (confidence[c].size() == confidence[0].size() && candidates[c].rgb.data.size() == 3 * confidence[0].size())
      continue;
    throw ShapeError("Pick: candidates for {} differ in size", candidates[c].name);
  }
}

/// Inverse of the squared error whose similarity is this confidence.
float Precision(float confidence) {
  return 1 / (kSensorNoise + SquaredErrorOf(std::clamp(confidence, kMinConfidence, kMaxConfidence)));
}

}  // namespace

Validated Pick(const std::vector<Proposal>& candidates, const std::vector<ConfidenceMap>& confidence, PickRule rule) {
  CheckSizes(candidates, confidence);
  const size_t n = candidates.size(), pixels = confidence[0].size();
  if (rule == PickRule::kView || n == 1) {
    const auto mean = [&](const ConfidenceMap& map) { return std::accumulate(map.begin(), map.end(), 0.0); };
    size_t best = 0;
    for (size_t c = 1; c < n; ++c) best = mean(confidence[c]) > mean(confidence[best]) ? c : best;
    return {candidates[best], confidence[best]};
  }
  Validated picked{candidates[0], ConfidenceMap(pixels)};
  picked.proposal.source = kMixed;
  picked.proposal.spread.assign(pixels, 0);
  picked.proposal.provenance.assign(pixels, 0);
  picked.proposal.inv_depth.assign(pixels, 0);
  for (size_t i = 0; i < pixels; ++i) {
    size_t best = 0;
    for (size_t c = 1; c < n; ++c) best = confidence[c][i] > confidence[best][i] ? c : best;
    if (!candidates[best].provenance.empty()) picked.proposal.provenance[i] = candidates[best].provenance[i];
    if (!candidates[best].inv_depth.empty()) picked.proposal.inv_depth[i] = candidates[best].inv_depth[i];
    float total = 0, sum_confidence = 0, rgb[3] = {0, 0, 0};
    for (size_t c = 0; c < n; ++c) {
      const float weight = rule == PickRule::kBlend ? Precision(confidence[c][i]) : (c == best ? 1.f : 0.f);
      for (size_t k = 0; k < 3; ++k) rgb[k] += weight * candidates[c].rgb.data[3 * i + k];
      sum_confidence += weight * confidence[c][i];
      total += weight;
    }
    float squares = 0;
    for (size_t k = 0; k < 3; ++k) {
      picked.proposal.rgb.data[3 * i + k] = rgb[k] / total;
      for (size_t c = 0; c < n; ++c) {
        const float d = candidates[c].rgb.data[3 * i + k] - rgb[k] / total;
        squares += d * d;
      }
    }
    picked.proposal.spread[i] = std::sqrt(squares / static_cast<float>(3 * n));
    picked.confidence[i] = sum_confidence / total;
  }
  return picked;
}

}  // namespace oraclegs
