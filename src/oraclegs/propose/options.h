#pragma once

#include <filesystem>
#include <string>

#include "oraclegs/core/options.h"

namespace oraclegs {

struct ProposeOptions {
  std::string proposers = "both";
  std::filesystem::path proposal_folder;
  int opinions = 4;
  double opinion_share = 0.3;
  double opinion_finish = 0.15;
  int opinion_gaussians = 40000;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("proposers", self.proposers,
          "What proposes new views: warp = photographs carried there by their depth, splat = the mean of quick models "
          "that each left some photographs out at first, both, seva = a generative network that needs weights, all "
          "three, or none",
          Choice{{"both", "warp", "splat", "seva", "all", "none"}});
    visit(
        "proposal-folder", self.proposal_folder,
        "Also train on these views, made by any other generator: pictures with transforms.json, or synthetic_N/ named "
        "like the scene's pictures, with synthetic_N_attention_maps/ as their confidence");
    visit("opinions", self.opinions, "Quick models that splat trains", Range{2, 16});
    visit("opinion-share", self.opinion_share,
          "Iterations of a quick model without the photographs it leaves out, as a share of --iterations: what it "
          "then believes of those is what the oracle learns from",
          Range{0.01, 1});
    visit("opinion-finish", self.opinion_finish,
          "Iterations that follow with all photographs, as a share of --iterations: proposals are rendered from the "
          "models that this leaves; 0 = from those that left some out",
          Range{0, 1});
    visit("opinion-gaussians", self.opinion_gaussians, "Gaussians of a quick model at most", Range{1, 1e8});
  }

  /// True when proposer `word` is among those that --proposers names.
  bool Names(const std::string& word) const {
    return proposers == word || proposers == "all" || (proposers == "both" && word != "seva");
  }
};

}  // namespace oraclegs
