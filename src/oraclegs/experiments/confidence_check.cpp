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

void ConfidenceCheck::Add(const CheckedPixels& proposal) {
  const size_t size = proposal.confidence.size();
  if (proposal.tampered.size() != size || proposal.unseen.size() != size || proposal.kinds.size() != size) {
    throw ShapeError("ConfidenceCheck: {} confidences, masks of {}, {} and {} pixels", size, proposal.tampered.size(),
                     proposal.unseen.size(), proposal.kinds.size());
  }
  for (size_t i = 0; i < size; ++i) {
    Pixels& pixels = proposal.unseen[i] > 127 ? unseen_ : seen_;
    pixels.confidence.push_back(static_cast<float>(proposal.confidence[i]) / 255);
    pixels.tampered.push_back(proposal.tampered[i] > 127);
    pixels.kinds.push_back(proposal.kinds[i]);
  }
}

TamperedConfidence ConfidenceCheck::Result() const {
  TamperedConfidence result;
  result.auroc = AurocOf(seen_.confidence, seen_.tampered);
  result.auroc_void = AurocOf(unseen_.confidence, unseen_.tampered);
  for (size_t kind = 0; kind < result.auroc_of_kind.size(); ++kind) {
    std::vector<float> confidence;
    std::vector<bool> of_kind;
    for (size_t i = 0; i < seen_.confidence.size(); ++i) {
      const bool has = seen_.tampered[i] && (seen_.kinds[i] >> kind & 1) != 0;
      if (!has && seen_.tampered[i]) continue;
      confidence.push_back(seen_.confidence[i]);
      of_kind.push_back(has);
    }
    result.auroc_of_kind[kind] = AurocOf(confidence, of_kind);
  }
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
