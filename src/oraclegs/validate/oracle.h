#pragma once
// Classifies each pixel of a proposal: how far the images support it.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// U of the paper, height * width, [0, 1], 1 = trust. Called confidence in code and files.
using ConfidenceMap = std::vector<float>;

/// A proposal whose confidence is asked for.
struct Query {
  Proposal proposal;
  /// Index of the training view that stands at the proposal's pose and that no evidence may come from; nothing for a
  /// proposal of a new pose.
  std::optional<int> held_out = {};
  /// What proxy models show at its pose, made without the view that is held out; empty = there are none. Compared with
  /// the proposals of generators that nothing is known of.
  ImageF proxy_render = {};
};

class Oracle {
 public:
  virtual ~Oracle() = default;
  virtual std::string name() const = 0;

  /// One map for each query, in their order. An oracle that looks at several proposals at once (VGGT) may compare those
  /// of one call with each other; for all others a map does not depend on what else is asked in the same call, and
  /// callers cut many proposals into calls of a few to bound memory.
  virtual std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries) const = 0;

  /// The same for proposals of new poses.
  std::vector<ConfidenceMap> Predict(const std::vector<Proposal>& proposals) const {
    std::vector<Query> queries;
    for (const Proposal& p : proposals) queries.push_back({p});
    return Predict(queries);
  }
};

/// Trusts everything: what a run without an oracle is compared with.
std::unique_ptr<Oracle> MakeUniformOracle();

}  // namespace oraclegs
