#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// Proposer of images that were made for all targets at once and are stored as proposals/SOURCE/NAME.png. It cannot
/// hold a view out and has no answer then; the oracle applies its calibration by other proposers.
class StoredProposer : public Proposer {
 public:
  StoredProposer(const std::filesystem::path& proposals, std::string source)
      : source_(std::move(source)), folder_(proposals / source_) {}
  std::string name() const override { return source_; }
  /// Reads the stored image. Throws InputError for another size than the target's.
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override;

 private:
  std::string source_;
  std::filesystem::path folder_;
};

}  // namespace oraclegs
