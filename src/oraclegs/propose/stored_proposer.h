#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// Proposer of images that were made for all targets at once and lie in proposals/SOURCE/NAME.png. It cannot hold a
/// view out: asked to, it has no answer, and the oracle applies what it learned from other proposers.
class StoredProposer : public Proposer {
 public:
  StoredProposer(const std::filesystem::path& proposals, std::string source)
      : source_(std::move(source)), folder_(proposals / source_) {}
  std::string name() const override { return source_; }
  /// Throws InputError for an image of another size than the target's.
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override;

 private:
  std::string source_;
  std::filesystem::path folder_;
};

}  // namespace oraclegs
