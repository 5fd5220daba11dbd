#pragma once

#include <filesystem>
#include <string>

#include "oraclegs/core/options.h"

namespace oraclegs {

enum class ProposerChoice { kBoth, kWarp, kSplat, kSeva, kCommand, kAll, kNone };

template <>
struct EnumWords<ProposerChoice> {
  static constexpr EnumWord<ProposerChoice> kWords[] = {
      {ProposerChoice::kBoth, "both"}, {ProposerChoice::kWarp, "warp"},       {ProposerChoice::kSplat, "splat"},
      {ProposerChoice::kSeva, "seva"}, {ProposerChoice::kCommand, "command"}, {ProposerChoice::kAll, "all"},
      {ProposerChoice::kNone, "none"}};
};

/// Size of the proposals.
enum class ProposalSize {
  kView,  ///< of the photos
  kOwn,   ///< at which the generator works
};
template <>
struct EnumWords<ProposalSize> {
  static constexpr EnumWord<ProposalSize> kWords[] = {{ProposalSize::kView, "view"}, {ProposalSize::kOwn, "own"}};
};

struct ProposeOptions {
  Auto<ProposerChoice> proposers = {};  ///< see Choice
  std::string generator;
  std::filesystem::path proposal_folder;
  ProposalSize proposal_size = ProposalSize::kView;
  int proxy_models = 2;
  double proxy_share = 0.2;
  Auto<double> proxy_finish;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("proposers", self.proposers,
          "What proposes new views: splat = an ensemble of proxy models, short trainings that each hold some photos "
          "out; warp = photos warped by their depth; both; seva = Stable Virtual Camera, a generative network that "
          "needs weights; all = these three; command = the program of --generator alone; none = nothing; auto = splat, "
          "or warp with --quality draft");
    visit("generator", self.generator,
          "Shell command of a program that generates the proposed views: from the folder {request}, with their poses, "
          "the photos warped to them and masks of the holes, into the folder {answer}, one image for each pose, e.g. "
          "\"python3 my_model.py {request} {answer}\". With --proposers command it is asked alone, with any other word "
          "beside the others (docs/generators.md)");
    visit("proposal-folder", self.proposal_folder,
          "Also train on these views, made by any other generator: images with transforms.json, or synthetic_N/ named "
          "like the scene's images, with synthetic_N_attention_maps/ as their confidence");
    visit(
        "proposal-size", self.proposal_size,
        "Size of the proposed views: view = of the photos; own = at which seva works (--seva-short-side), so that the "
        "loss sees its pixels as they are",
        Tier::kSetting);
    visit("proxy-models", self.proxy_models,
          "Proxy models to train for splat; of few photos more, so that each sees three", Range{2, 16}, Tier::kSetting);
    visit("proxy-share", self.proxy_share,
          "Iterations of a proxy model with photos held out, as a fraction of --iterations; the errors on these photos "
          "calibrate the confidence",
          Range{0.01, 1}, Tier::kSetting);
    visit(
        "proxy-finish", self.proxy_finish,
        "Iterations that follow with all photos, as a fraction of --iterations; proposals are rendered from the "
        "models after these; 0 = from the models with photos held out; auto = 0.4, or 0.6 of an object before a plain "
        "background",
        Range{0, 1}, Tier::kSetting);
  }

  ProposerChoice Choice() const { return proposers.ValueOr(ProposerChoice::kSplat); }

  /// Whether proxy models are the only proposer.
  bool ByProxiesAlone() const {
    return Choice() == ProposerChoice::kSplat && generator.empty() && proposal_folder.empty();
  }

  /// Whether --proposers includes `one` (warp, splat or seva), or, for the command, --generator is given and proposals
  /// are made.
  bool Uses(ProposerChoice one) const {
    const ProposerChoice choice = Choice();
    if (one == ProposerChoice::kCommand) return choice != ProposerChoice::kNone && !generator.empty();
    return choice == one || choice == ProposerChoice::kAll ||
           (choice == ProposerChoice::kBoth && one != ProposerChoice::kSeva);
  }
};

/// Time limit of the command of --generator; may differ when a run is continued.
struct GeneratorLimits {
  int generator_timeout = 3600;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("generator-timeout", self.generator_timeout,
          "Seconds after which the command of --generator is stopped, with an error; 0 = never", Range{0, 1e7});
  }
};

}  // namespace oraclegs
