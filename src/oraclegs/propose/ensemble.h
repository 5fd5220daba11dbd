#pragma once
// Proposals from an ensemble: renders of a new view by proxy models, trained quickly on the training views
// (docs/method.md#proxy-models).

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "oraclegs/propose/options.h"
#include "oraclegs/propose/proposal.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// A member of the ensemble: a quickly trained model; some training views were held out in its first phase.
struct ProxyModel {
  Gaussians before;           ///< before training with all views: the leave-k-out model
  Gaussians gaussians;        ///< after training with all views
  std::vector<int> held_out;  ///< indices of training views
};

/// Proposer "proxies": the mean of the members' renders (without the most extreme values where there are four or more),
/// and their spread. A held-out view is rendered by the leave-k-out models that were trained without it; nullopt when
/// there is none.
class EnsembleProposer : public Proposer {
 public:
  EnsembleProposer(std::vector<ProxyModel> members, RenderOptions render);
  std::string name() const override { return kProxiesWord; }
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override;

 private:
  std::vector<ProxyModel> members_;
  RenderOptions render_;
  mutable std::mutex mutex_;  ///< the rasterizer uses all threads itself
  std::unique_ptr<Rasterizer> rasterizer_;
};

/// The views that are held out from member `member` of `members`: every members-th, beginning with that index, so that
/// each view is held out from exactly one. Empty for a single member.
std::vector<int> HeldOutViews(int views, int members, int member);

}  // namespace oraclegs
