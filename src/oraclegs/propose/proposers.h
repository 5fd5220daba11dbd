#pragma once
// The proposers of a run with the warper that they and the oracle share, and their candidates.

#include <memory>
#include <optional>
#include <vector>

#include "oraclegs/propose/proposal.h"
#include "oraclegs/propose/warp.h"

namespace oraclegs {

/// A proposer and when it is asked.
struct AskedProposer {
  std::unique_ptr<Proposer> proposer;
  bool paints = true;    ///< false: asked for held-out views alone, from which the oracle learns
  bool renders = false;  ///< shows renders of models of the whole scene, and uses all threads for each
};

/// Asks proposers in their order.
class Proposers {
 public:
  /// `warper`: not null.
  Proposers(std::unique_ptr<Warper> warper, std::vector<AskedProposer> members)
      : warper_(std::move(warper)), members_(std::move(members)) {}

  const Warper& warper() const { return *warper_; }
  /// Candidates of each target, in their order. held_out: of each target, the training view that no evidence may come
  /// from; empty = none of any. A target that no proposer answers has none.
  std::vector<std::vector<Proposal>> Ask(const std::vector<Target>& targets,
                                         const std::vector<std::optional<int>>& held_out = {}) const;

  /// True where one of them renders models of the scene.
  bool has_proxy_models() const { return Renderer() != nullptr; }
  /// Render of these models at a new pose; nullopt without them.
  std::optional<Proposal> ProxyRender(const Target& target) const;

 private:
  const Proposer* Renderer() const;

  std::unique_ptr<Warper> warper_;
  std::vector<AskedProposer> members_;
};

}  // namespace oraclegs
