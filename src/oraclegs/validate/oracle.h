#pragma once
// Says of each pixel of a proposal how far the photographs support it.

#include <memory>
#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// U of the paper, height * width, [0, 1], 1 = trust. Called confidence in code and files.
using ConfidenceMap = std::vector<float>;

/// A photograph that was hidden, and what a proposer said stood there; or, with none hidden, any proposal.
struct HiddenPhotograph {
  int photograph = -1;  ///< index, -1 = none
  Proposal proposal;
  ConfidenceMap second = {};  ///< what a second oracle said of it (ConsistencyOracle::Look); empty = nobody was asked
};

class Oracle {
 public:
  virtual ~Oracle() = default;
  virtual std::string name() const = 0;

  /// One map for each, in their order, judged without the photograph that is hidden from it. An oracle that looks at
  /// several proposals at once (VGGT) may judge those of one call by each other; for all others a map does not depend
  /// on what else is asked in the same call, and callers cut many proposals into calls of a few to bound memory.
  virtual std::vector<ConfidenceMap> Judge(const std::vector<HiddenPhotograph>& hidden) const = 0;

  /// The same with nothing hidden.
  std::vector<ConfidenceMap> Validate(const std::vector<Proposal>& proposals) const {
    std::vector<HiddenPhotograph> none_hidden;
    for (const Proposal& p : proposals) none_hidden.push_back({-1, p});
    return Judge(none_hidden);
  }
};

/// Trusts everything: what a run without an oracle is compared with.
std::unique_ptr<Oracle> MakeUniformOracle();

}  // namespace oraclegs
