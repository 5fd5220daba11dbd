#pragma once
// One picture out of several candidates.

#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

enum class PickRule {
  kView,   ///< the candidate with the highest mean confidence
  kPixel,  ///< at each pixel the surest candidate
  kBlend,  ///< at each pixel the mean, weighted by the inverse of the squared error that the confidence stands for
};

/// A proposal as it is trained on.
struct Validated {
  Proposal proposal;
  ConfidenceMap confidence;
};

/// `candidates` are of one target and not empty; `confidence` belongs to them one by one. The source of a mixture is
/// kMixed, its spread that of the candidates; it keeps the provenance of the surest. Throws ShapeError when sizes
/// differ.
Validated Pick(const std::vector<Proposal>& candidates, const std::vector<ConfidenceMap>& confidence, PickRule rule);

}  // namespace oraclegs
