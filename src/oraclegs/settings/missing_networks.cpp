#include "oraclegs/settings/missing_networks.h"

#include <algorithm>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/settings/plan.h"
#include "oraclegs/weights/check.h"
#include "oraclegs/weights/folder.h"

namespace oraclegs {
namespace {

constexpr const char* kVggtModel = "vggt";
constexpr const char* kVggtFile = "--vggt-weights";

bool IsHere(const char* model) {
  try {
    return LocateWeights(model).has_value();
  } catch (const UsageError&) {  // there is no home folder
    return false;
  }
}

/// "--option word".
std::string Asked(const char* option, const std::string& word) { return fmt::format("--{} {}", option, word); }

void AddIf(bool missing, MissingNetwork network, std::vector<MissingNetwork>* list) {
  if (missing) list->push_back(std::move(network));
}

/// The words of --proposers without one of them; proxy models where nothing is left.
std::string WithoutProposer(const ProposeOptions& options, std::string_view word) {
  std::vector<std::string> words = SplitTrimmed(options.proposers.ValueOr(kProxiesWord), ',');
  std::erase(words, word);
  if (words.empty()) words.emplace_back(kProxiesWord);
  return fmt::format("{}", fmt::join(words, ","));
}

void AddProposer(const KnownProposer& proposer, const RunOptions& options, std::vector<MissingNetwork>* list) {
  if (!ProposesViews(options) || !options.propose.Uses(proposer.word)) return;
  MissingNetwork network{Asked("proposers", proposer.word),
                         {},
                         "",
                         Asked("proposers", WithoutProposer(options.propose, proposer.word)),
                         [word = proposer.word](RunOptions* o) {
                           o->propose.proposers = WithoutProposer(o->propose, word);
                           o->propose.proposal_size = ProposalSize::kView;  // nothing else has a size of its own
                         }};
  for (const char* model : proposer.networks) {
    const bool is_given = std::string_view(model) == "seva" && !options.weights.seva_weights.empty();
    const bool is_here = is_given ? !FindWeights(model, options.weights.seva_weights).empty() : IsHere(model);
    if (!is_here) network.models.emplace_back(model);
  }
  const bool missing = !network.models.empty();
  AddIf(missing, std::move(network), list);
}

void AddDepth(const RunOptions& options, std::vector<MissingNetwork>* list) {
  const Auto<DepthPrior>& prior = options.depth.depth_prior;
  if (!NeedsDepth(options) || (prior != DepthPrior::kMonocular && prior != DepthPrior::kFused)) return;
  AddIf(FindWeights(kDepthModel, options.weights.depth_weights).empty(),
        {Asked("depth-prior", Word(prior.value())),
         {kDepthModel},
         "--depth-weights",
         "--depth-prior stereo",
         [](RunOptions* o) { o->depth.depth_prior = DepthPrior::kStereo; }},
        list);
}

void AddOracle(const RunOptions& options, std::vector<MissingNetwork>* list) {
  const Auto<OracleKind>& oracle = options.validate.oracle;
  const bool asks_vggt = oracle == OracleKind::kVggt || oracle == OracleKind::kVggtAndConsistency;
  if (!HasProposals(options) || !asks_vggt) return;
  AddIf(!FindVggtWeights(options.weights.vggt_weights),
        {Asked("oracle", Word(oracle.value())),
         {kVggtModel},
         kVggtFile,
         "--oracle consistency",
         [](RunOptions* o) { o->validate.oracle = OracleKind::kConsistency; }},
        list);
}

/// Throws InputError where another version of SEVA lies in the place of the one that is fetched.
void RefuseOtherSeva(const RunOptions& options, const Listener& listener) {
  constexpr const char* kSeva = "seva";
  if (!ProposesViews(options) || !options.propose.Uses(kSeva) || !options.weights.seva_weights.empty()) return;
  if (!IsHere(kSeva)) return;
  RefuseAnotherNetwork(WeightsNamed(kSeva), AllWeights(), *LocateWeights(kSeva), listener);
}

/// Values of of(network) for each, without repetitions, in their order.
template <class Of>
std::vector<std::string> Distinct(const std::vector<MissingNetwork>& missing, const Of& of) {
  std::vector<std::string> texts;
  for (const MissingNetwork& network : missing) {
    for (const std::string& text : of(network)) {
      if (!text.empty() && std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
    }
  }
  return texts;
}

[[noreturn]] void Refuse(const std::vector<MissingNetwork>& missing) {
  std::vector<std::string> needs, commands;
  for (const MissingNetwork& network : missing) {
    needs.push_back(fmt::format("{} needs the weights of {}", network.asked, fmt::join(network.models, ", ")));
  }
  for (const std::string& model : Distinct(missing, [](const MissingNetwork& n) { return n.models; })) {
    commands.push_back(fmt::format("`oraclegs models fetch {}`", model));
  }
  const auto files = Distinct(missing, [](const MissingNetwork& n) { return std::vector{n.names_a_file}; });
  const std::string elsewhere = files.empty() ? "" : fmt::format("; {} if they are elsewhere", fmt::join(files, ", "));
  throw InputError("{}, which are not here; get them with {}{}; --allow-fallback does without them",
                   fmt::join(needs, ", "), fmt::join(commands, ", "), elsewhere);
}

}  // namespace

std::vector<MissingNetwork> MissingNetworks(const RunOptions& options, bool has_poses) {
  std::vector<MissingNetwork> missing;
  if (!has_poses && options.input.poses == PoseSource::kVggt) {
    AddIf(!FindVggtWeights(options.weights.vggt_weights),
          {"--poses vggt",
           {kVggtModel},
           kVggtFile,
           "--poses colmap",
           [](RunOptions* o) { o->input.poses = PoseSource::kColmap; }},
          &missing);
  }
  AddDepth(options, &missing);
  for (const KnownProposer& proposer : KnownProposers()) AddProposer(proposer, options, &missing);
  AddOracle(options, &missing);
  if (options.weights.lpips == LpipsUse::kRequired) {
    AddIf(FindLpips(options.weights).empty(),
          {"--lpips required",
           {kLpipsModel},
           "--lpips-weights",
           "L1 and SSIM, and no LPIPS among the scores,",
           [](RunOptions* o) { o->weights.lpips = LpipsUse::kWhereFound; }},
          &missing);
  }
  return missing;
}

RunOptions WithNetworksAtHand(const RunOptions& options, bool has_poses, const Listener& listener) {
  const std::vector<MissingNetwork> missing = MissingNetworks(options, has_poses);
  if (!missing.empty() && !options.weights.allow_fallback) Refuse(missing);
  RefuseOtherSeva(options, listener);
  RunOptions changed = options;
  for (const MissingNetwork& network : missing) {
    network.apply(&changed);
    listener(Warning{fmt::format("{}: the weights of {} are not here; {} instead", network.asked,
                                 fmt::join(network.models, ", "), network.instead)});
  }
  return changed;
}

}  // namespace oraclegs
