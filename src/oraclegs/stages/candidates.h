#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/propose/proposal.h"

namespace oraclegs {

/// The candidates that stage "propose" made, for stage "validate" of the same process: the same floats without making
/// them twice. Holds as many targets as fit; the others are made again.
class CandidateStore {
 public:
  explicit CandidateStore(uint64_t limit_bytes = 0) : limit_(limit_bytes) {}

  /// Forgets them where they do not fit.
  void Keep(const std::string& target, std::vector<Proposal> candidates);
  /// Those of a target, which the store then holds no more; nothing when it does not hold them.
  std::optional<std::vector<Proposal>> Take(const std::string& target);
  uint64_t bytes() const { return bytes_; }

 private:
  uint64_t limit_, bytes_ = 0;
  std::map<std::string, std::vector<Proposal>> by_target_;
};

}  // namespace oraclegs
