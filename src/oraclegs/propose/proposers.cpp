#include "oraclegs/propose/proposers.h"

#include <algorithm>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {

std::vector<std::vector<Proposal>> Proposers::Ask(const std::vector<Target>& targets,
                                                  const std::vector<std::optional<int>>& held_out) const {
  std::vector<std::vector<Proposal>> candidates(targets.size());
  for (const AskedProposer& member : members_) {
    const auto ask = [&](int64_t t) {
      ThrowIfInterrupted();
      const auto i = static_cast<size_t>(t);
      const std::optional<int> without = held_out.empty() ? std::nullopt : held_out[i];
      if (!without && !member.paints) return;
      if (auto answer = member.proposer->Propose(targets[i], without)) candidates[i].push_back(std::move(*answer));
    };
    const auto count = static_cast<int64_t>(targets.size());
    if (member.renders) {
      for (int64_t t = 0; t < count; ++t) ask(t);
    } else {
      ParallelFor(count, ask);
    }
  }
  return candidates;
}

const Proposer* Proposers::Renderer() const {
  const auto found = std::find_if(members_.begin(), members_.end(), [](const auto& m) { return m.renders; });
  return found == members_.end() ? nullptr : found->proposer.get();
}

std::optional<Proposal> Proposers::ProxyRender(const Target& target) const {
  const Proposer* renderer = Renderer();
  return renderer != nullptr ? renderer->Propose(target, std::nullopt) : std::nullopt;
}

}  // namespace oraclegs
