#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/options.h"

namespace oraclegs {

/// Words of --proposers that code beside their rows knows: of automatic choices, of --generator, and of no proposals.
inline constexpr const char *kProxiesWord = "proxies", *kWarpWord = "warp", *kCommandWord = "command",
                            *kNoneWord = "none";

/// Names in `oraclegs models` of the weights of SEVA: its own network, the autoencoder and the image encoder.
inline constexpr const char* kSevaNetworks[] = {"seva", "sd21-vae", "openclip-vith14"};

/// A proposer as options, help and settings know it; its row (stages/proposer_row.h) has the rest.
struct KnownProposer {
  const char* word;  ///< word of --proposers; sources of its proposals, and their folders, begin with it
  const char* what;  ///< for the help
  std::vector<const char*> networks = {};  ///< names in `oraclegs models` of the weights that it needs
};

/// The proposers there are, in the order of the help.
const std::vector<KnownProposer>& KnownProposers();

/// Words that --proposers takes beside "auto".
std::vector<std::string> ProposerWords();
const char* ProposersHelp();

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
  Auto<std::string> proposers = {};  ///< see Words
  std::string generator;
  std::filesystem::path proposal_folder;
  ProposalSize proposal_size = ProposalSize::kView;
  int proxy_models = 2;
  double proxy_share = 0.2;
  Auto<double> proxy_finish;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("proposers", self.proposers, ProposersHelp(), WordList{ProposerWords()});
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
          "Proxy models to train for proxies; of few photos more, so that each sees three", Range{2, 16},
          Tier::kSetting);
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

  /// Words of --proposers, in their order; none for "none". --generator adds "command" to others.
  std::vector<std::string> Words() const;
  /// True when Words has the word.
  bool Uses(std::string_view word) const;
  /// True when proxy models are the only proposer.
  bool ByProxiesAlone() const;
};

/// Throws UsageError for a word of --proposers that nothing has, with the nearest one, where --proposers and
/// --generator contradict each other, and for a command that is not UTF-8.
void CheckProposers(const ProposeOptions& options);

/// Time limit of the commands of --generator and --masks; may differ when a run is continued.
struct GeneratorLimits {
  int generator_timeout = 3600;

  template <class Self, class V>
  static void Visit(Self& self, V&& visit) {
    visit("generator-timeout", self.generator_timeout,
          "Seconds after which the command of --generator or --masks is stopped, with an error; 0 = never",
          Range{0, 1e7});
  }
};

}  // namespace oraclegs
