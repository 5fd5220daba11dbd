#include "oraclegs/evaluate/block_quality.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/evaluate/rank_statistics.h"

namespace oraclegs {

void BlockSamples::Add(const ErrorMap& map) {
  const size_t pixels = static_cast<size_t>(map.width) * static_cast<size_t>(map.height);
  if (map.error.size() != pixels || map.confidence.size() != pixels || map.counts.size() != pixels) {
    throw ShapeError("BlockSamples: {} errors, {} confidences and a mask of {} for {} x {} pixels", map.error.size(),
                     map.confidence.size(), map.counts.size(), map.width, map.height);
  }
  for (int y0 = 0; y0 < map.height; y0 += kBlockSide) {
    for (int x0 = 0; x0 < map.width; x0 += kBlockSide) {
      double count = 0, error = 0, squares = 0, confidence = 0;
      for (int y = y0; y < std::min(map.height, y0 + kBlockSide); ++y) {
        for (int x = x0; x < std::min(map.width, x0 + kBlockSide); ++x) {
          const size_t i = static_cast<size_t>(y) * static_cast<size_t>(map.width) + static_cast<size_t>(x);
          if (!map.counts[i]) continue;
          const auto e = static_cast<double>(map.error[i]);
          ++count, error += e, squares += e * e, confidence += static_cast<double>(map.confidence[i]);
        }
      }
      if (2 * count < kBlockSide * kBlockSide) continue;
      mean_error_.push_back(static_cast<float>(error / count));
      rms_error_.push_back(static_cast<float>(std::sqrt(squares / count)));
      confidence_.push_back(static_cast<float>(confidence / count));
    }
  }
}

BlockQuality BlockSamples::Quality() const {
  const std::vector<double> ranks = Ranks(confidence_);
  std::vector<bool> wrong;
  for (const float rms : rms_error_) wrong.push_back(rms > kLargeBlockError);
  return {static_cast<int64_t>(mean_error_.size()), 0 - Correlation(ranks, Ranks(mean_error_)),
          AurocOfLowRank(ranks, wrong)};
}

nlohmann::json ToJson(const BlockQuality& quality) {
  const double auroc = quality.auroc_large_error;
  return {{"blocks", quality.blocks},
          {"spearman", quality.spearman},
          {"auroc_large_error", std::isfinite(auroc) ? nlohmann::json(auroc) : nlohmann::json()}};
}

}  // namespace oraclegs
