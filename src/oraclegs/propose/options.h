#pragma once

#include <filesystem>

#include "oraclegs/core/options.h"

namespace oraclegs {

enum class ProposerChoice { kBoth, kWarp, kSplat, kSeva, kAll, kNone };

template <>
struct EnumWords<ProposerChoice> {
  static constexpr EnumWord<ProposerChoice> kWords[] = {
      {ProposerChoice::kBoth, "both"}, {ProposerChoice::kWarp, "warp"}, {ProposerChoice::kSplat, "splat"},
      {ProposerChoice::kSeva, "seva"}, {ProposerChoice::kAll, "all"},   {ProposerChoice::kNone, "none"}};
};

struct ProposeOptions {
  ProposerChoice proposers = ProposerChoice::kBoth;
  std::filesystem::path proposal_folder;
  int proxy_models = 4;
  double proxy_share = 0.3;
  double proxy_finish = 0.15;
  int proxy_gaussians = 40000;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("proposers", self.proposers,
          "What proposes new views: warp = photos warped by their depth, splat = the mean of quickly trained proxy "
          "models, each of which some photos are held out from at first, both, seva = a generative network that needs "
          "weights, all three, or none");
    visit("proposal-folder", self.proposal_folder,
          "Also train on these views, made by any other generator: images with transforms.json, or synthetic_N/ named "
          "like the scene's images, with synthetic_N_attention_maps/ as their confidence");
    visit("proxy-models", self.proxy_models, "Proxy models that splat trains", Range{2, 16});
    visit("proxy-share", self.proxy_share,
          "Iterations of a proxy model without its held-out photos, as a share of --iterations: how wrong it then is "
          "about those is what the oracle learns from",
          Range{0.01, 1});
    visit("proxy-finish", self.proxy_finish,
          "Iterations that follow with all photos, as a share of --iterations; proposals are rendered from the models "
          "after these; 0 = from the models with photos held out",
          Range{0, 1});
    visit("proxy-gaussians", self.proxy_gaussians, "Gaussians of a proxy model at most", Range{1, 1e8});
  }

  /// Whether warp, splat or seva is among those that --proposers names.
  bool Uses(ProposerChoice one) const {
    return proposers == one || proposers == ProposerChoice::kAll ||
           (proposers == ProposerChoice::kBoth && one != ProposerChoice::kSeva);
  }
};

}  // namespace oraclegs
