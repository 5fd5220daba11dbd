#pragma once
// One image out of several candidates (docs/method.md#mixing-candidates).

#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"
#include "oraclegs/validate/options.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// A proposal as it is trained on.
struct Validated {
  Proposal proposal;
  ConfidenceMap confidence;
};

/// `candidates` are of one target and not empty; `confidence` belongs to them one by one. The source of a mixture is
/// kMixed, its spread that of the candidates; it keeps the provenance of the candidate of highest confidence. Throws
/// ShapeError when sizes differ.
Validated Pick(const std::vector<Proposal>& candidates, const std::vector<ConfidenceMap>& confidence, PickRule rule);

}  // namespace oraclegs
