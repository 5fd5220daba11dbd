#include "oraclegs/experiments/confidence_check.h"

#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/evaluate/rank_statistics.h"

namespace oraclegs {
namespace {

std::optional<double> AurocOf(const std::vector<float>& confidence, const std::vector<bool>& tampered) {
  const double auroc = AurocOfLowRank(Ranks(confidence), tampered);
  return std::isnan(auroc) ? std::nullopt : std::optional(auroc);
}

}  // namespace

void ConfidenceCheck::Add(const PixelMask& confidence, const PixelMask& tampered, const PixelMask& unseen) {
  if (confidence.size() != tampered.size() || confidence.size() != unseen.size()) {
    throw ShapeError("ConfidenceCheck: {} confidences, masks of {} and {} pixels", confidence.size(), tampered.size(),
                     unseen.size());
  }
  for (size_t i = 0; i < confidence.size(); ++i) {
    Pixels& pixels = unseen[i] > 127 ? unseen_ : seen_;
    pixels.confidence.push_back(static_cast<float>(confidence[i]) / 255);
    pixels.tampered.push_back(tampered[i] > 127);
  }
}

TamperedConfidence ConfidenceCheck::Result() const {
  TamperedConfidence result;
  result.auroc = AurocOf(seen_.confidence, seen_.tampered);
  result.auroc_void = AurocOf(unseen_.confidence, unseen_.tampered);
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (const Pixels* pixels : {&seen_, &unseen_}) {
    for (size_t i = 0; i < pixels->confidence.size(); ++i) {
      const size_t of = pixels->tampered[i] ? 1 : 0;
      sum[of] += static_cast<double>(pixels->confidence[i]);
      ++count[of];
    }
  }
  if (count[0] > 0) result.on_honest = sum[0] / count[0];
  if (count[1] > 0) result.on_tampered = sum[1] / count[1];
  return result;
}

}  // namespace oraclegs
