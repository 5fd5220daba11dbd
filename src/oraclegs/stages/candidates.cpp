#include "oraclegs/stages/candidates.h"

#include <utility>

namespace oraclegs {
namespace {

uint64_t BytesOf(const std::vector<Proposal>& candidates) {
  uint64_t bytes = 0;
  for (const Proposal& p : candidates) {
    bytes += (p.rgb.data.size() + p.inv_depth.size() + p.spread.size()) * sizeof(float);
    bytes += p.provenance.size() * sizeof(uint16_t);
  }
  return bytes;
}

}  // namespace

void CandidateStore::Keep(const std::string& target, std::vector<Proposal> candidates) {
  const uint64_t bytes = BytesOf(candidates);
  if (bytes_ + bytes > limit_) return;
  bytes_ += bytes;
  by_target_[target] = std::move(candidates);
}

std::optional<std::vector<Proposal>> CandidateStore::Take(const std::string& target) {
  const auto found = by_target_.find(target);
  if (found == by_target_.end()) return std::nullopt;
  std::vector<Proposal> candidates = std::move(found->second);
  bytes_ -= BytesOf(candidates);
  by_target_.erase(found);
  return candidates;
}

}  // namespace oraclegs
