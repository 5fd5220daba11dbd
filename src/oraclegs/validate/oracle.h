#pragma once
// Oracles classify each pixel of a proposal by how far the images support it.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// U of the paper, height * width, [0, 1], 1 = full trust. Called confidence in code and files.
using ConfidenceMap = std::vector<float>;

/// A proposal whose confidence is asked for.
struct Query {
  Proposal proposal;
  /// Index of the training view at the proposal's pose, which must give no evidence; nullopt for a proposal of a new
  /// pose.
  std::optional<int> held_out = {};
  /// Render of proxy models at its pose, made without the held-out view; empty = none. It is compared with proposals of
  /// generators without training samples.
  ImageF proxy_render = {};
};

class Oracle {
 public:
  virtual ~Oracle() = default;
  virtual std::string name() const = 0;

  /// One map for each query, in their order. An oracle that takes several proposals at once (VGGT) may compare those of
  /// one call with each other. For all others a map does not depend on the other queries, and callers split many
  /// proposals into small calls to bound memory.
  virtual std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries) const = 0;

  /// Maps for proposals of new poses.
  std::vector<ConfidenceMap> Predict(const std::vector<Proposal>& proposals) const {
    std::vector<Query> queries;
    for (const Proposal& p : proposals) queries.push_back({p});
    return Predict(queries);
  }
};

/// Oracle with confidence 1 everywhere, for comparison.
std::unique_ptr<Oracle> MakeUniformOracle();

}  // namespace oraclegs
