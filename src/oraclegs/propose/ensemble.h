#pragma once
// Proposals from an ensemble: what proxy models, trained quickly on the training views, show in a new view
// (docs/method.md#proxy-models).

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "oraclegs/propose/proposal.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// A member of the ensemble: a model that some training views are held out from at first.
struct ProxyModel {
  Gaussians before;                    ///< before training with all views: the leave-k-out model
  std::optional<Gaussians> gaussians;  ///< after it; nothing for one that did not go on
  std::vector<int> held_out;           ///< indices of training views
};

/// Proposer "splat": the mean of the renders of the members that were trained with all views (without the most extreme
/// values where there are four or more). A held-out view is shown by the leave-k-out models that were trained without
/// it; nothing when there is none. Where each view is held out from two members or more, the spread of a proposal is
/// the sample deviation of such leave-k-out renders, here as there; else it has none.
class EnsembleProposer : public Proposer {
 public:
  EnsembleProposer(std::vector<ProxyModel> members, RenderOptions render);
  std::string name() const override { return "splat"; }
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override;

 private:
  std::vector<ProxyModel> members_;
  RenderOptions render_;
  bool overlaps_;             ///< each held-out view has two leave-k-out models or more
  mutable std::mutex mutex_;  ///< the rasteriser uses all threads itself
  std::unique_ptr<Rasterizer> rasterizer_;
};

/// Training views from which on each is held out from half of the members, so that they can be compared where none of
/// them has seen the truth; fewer are held out from one, for a model needs what little there is.
inline constexpr int kMinViewsForOverlap = 8;

/// The views that are held out from member `member` of `members`: view v from the members v, v + 1, ... modulo
/// `members`, half of them (rounded down) from kMinViewsForOverlap views on, else one. None from a single member.
std::vector<int> HeldOutViews(int views, int members, int member);

}  // namespace oraclegs
