#pragma once
// Says of each pixel of a proposal how far the photographs support it.

#include <memory>
#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// U of the paper, height * width, [0, 1], 1 = trust. Called confidence in code and files.
using ConfidenceMap = std::vector<float>;

class Oracle {
 public:
  virtual ~Oracle() = default;
  virtual std::string name() const = 0;

  /// One map for each proposal, in their order. A proposal's map does not depend on which others are asked about in the
  /// same call: callers cut many proposals into calls of a few to bound memory.
  virtual std::vector<ConfidenceMap> Validate(const std::vector<Proposal>& proposals) const = 0;
};

/// Trusts everything: what a run without an oracle is compared with.
std::unique_ptr<Oracle> MakeUniformOracle();

}  // namespace oraclegs
