#pragma once

#include <optional>
#include <string>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// Makes candidate images. One object may be asked from several threads at once.
class Proposer {
 public:
  virtual ~Proposer() = default;

  /// The word of --proposers, and the source of its proposals.
  virtual std::string name() const = 0;

  /// What `target` sees, made without the training view of index `held_out`; nothing held out: from all of them. Held
  /// out, the target is that view's own camera, and the answer shows how wrong the proposer is where no image was
  /// taken: validation measures it. Stereo has used the held-out view; only its own depth map is left out. Nothing when
  /// the proposer has no answer, or cannot hold a view out.
  virtual std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const = 0;
};

}  // namespace oraclegs
