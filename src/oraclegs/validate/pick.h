#pragma once
// Fusion of several candidates into one image (docs/method.md#mixing-candidates).

#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"
#include "oraclegs/validate/options.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// Proposal and confidence for training.
struct Validated {
  Proposal proposal;
  ConfidenceMap confidence;
};

/// Fuses `candidates` of one target, at least one, with their confidence maps in the same order. The source of a
/// mixture is kMixed, and its spread is that of the candidates; it keeps the provenance of the candidate of highest
/// confidence. Throws ShapeError when sizes differ.
Validated Pick(const std::vector<Proposal>& candidates, const std::vector<ConfidenceMap>& confidence, PickRule rule);

}  // namespace oraclegs
