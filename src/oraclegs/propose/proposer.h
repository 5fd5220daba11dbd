#pragma once

#include <optional>
#include <string>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// Makes candidate pictures. One object may be asked from several threads at once.
class Proposer {
 public:
  virtual ~Proposer() = default;

  /// The word of --proposers, and the source of its proposals.
  virtual std::string name() const = 0;

  /// What `target` sees, judged without training photograph `hidden` (-1: with all of them). With `hidden` the target
  /// is that photograph's own camera and the answer shows how wrong the proposer is where nobody looked: validation
  /// measures it. (Stereo has
  /// seen the photograph; only what it found there is left out.) Nothing when the proposer has no answer, or cannot
  /// forget a photograph.
  virtual std::optional<Proposal> Propose(const Target& target, int hidden) const = 0;
};

}  // namespace oraclegs
