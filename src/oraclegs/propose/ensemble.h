#pragma once
// A second opinion: what quick models trained on the photographs show in a new view.

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "oraclegs/propose/proposer.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// A quick model, trained without some of the training photographs, and then with all.
struct ProxyModel {
  Gaussians before;         ///< what it was when it had not seen `unseen`
  Gaussians gaussians;      ///< what it became
  std::vector<int> unseen;  ///< indices of training photographs
};

/// Proposer "splat": the mean of the opinions' renders (without the most extreme values where there are four or more),
/// and how much they differ. A hidden photograph is shown as the opinions believed it that had not seen it; nothing
/// when all had.
class EnsembleProposer : public Proposer {
 public:
  EnsembleProposer(std::vector<ProxyModel> opinions, RenderOptions render);
  std::string name() const override { return "splat"; }
  std::optional<Proposal> Propose(const Target& target, int hidden) const override;

 private:
  std::vector<ProxyModel> opinions_;
  RenderOptions render_;
  mutable std::mutex mutex_;  ///< the rasteriser uses all threads itself
  std::unique_ptr<Rasterizer> rasterizer_;
};

/// The photographs that opinion k of n leaves out: every n-th, beginning with the k-th; each photograph is left out by
/// exactly one.
std::vector<int> LeftOut(int photographs, int opinions, int k);

}  // namespace oraclegs
