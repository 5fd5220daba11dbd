#include "oraclegs/propose/options.h"

#include <algorithm>
#include <iterator>

#include "oraclegs/core/text.h"
#include "oraclegs/core/user_command.h"

namespace oraclegs {
namespace {

std::vector<std::string> Asked(const ProposeOptions& options) {
  return SplitTrimmed(options.proposers.is_auto() ? kProxiesWord : options.proposers.value(), ',');
}

bool Has(const std::vector<std::string>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

const std::vector<KnownProposer>& KnownProposers() {
  static const std::vector<KnownProposer> known = {
      {kProxiesWord, "an ensemble of proxy models, short trainings that each hold some photos out"},
      {kWarpWord, "photos warped by their depth"},
      {"seva",
       "Stable Virtual Camera, a generative network that needs weights",
       {std::begin(kSevaNetworks), std::end(kSevaNetworks)}},
      {kCommandWord, "the program of --generator"},
  };
  return known;
}

std::vector<std::string> ProposerWords() {
  std::vector<std::string> words;
  for (const KnownProposer& one : KnownProposers()) words.emplace_back(one.word);
  words.emplace_back(kNoneWord);
  return words;
}

const char* ProposersHelp() {
  static const std::string help = [] {
    std::string text = "What proposes new views, words separated by commas: ";
    for (const KnownProposer& one : KnownProposers()) text += fmt::format("{} = {}; ", one.word, one.what);
    return text + fmt::format("{} = nothing; auto = {}; with --quality draft {}, of five photos or fewer {}", kNoneWord,
                              kProxiesWord, kNoneWord, kWarpWord);
  }();
  return help.c_str();
}

std::vector<std::string> ProposeOptions::Words() const {
  std::vector<std::string> words = Asked(*this);
  if (Has(words, kNoneWord)) return {};
  if (!generator.empty() && !Has(words, kCommandWord)) words.emplace_back(kCommandWord);
  return words;
}

bool ProposeOptions::Uses(std::string_view word) const { return Has(Words(), word); }

bool ProposeOptions::ByProxiesAlone() const {
  return Words() == std::vector<std::string>{kProxiesWord} && proposal_folder.empty();
}

void CheckProposers(const ProposeOptions& options) {
  const std::vector<std::string> asked = Asked(options), known = ProposerWords();
  const auto unknown = std::find_if(asked.begin(), asked.end(), [&](const auto& word) { return !Has(known, word); });
  const bool none = Has(asked, kNoneWord);
  if (asked.empty() || unknown != asked.end() || (none && asked.size() > 1)) {
    throw UsageError("--proposers is '{}', must be auto, none, or of the words: {}{}", options.proposers.value(),
                     fmt::join(known.begin(), known.end() - 1, ", "),
                     unknown != asked.end() ? DidYouMean(*unknown, known) : "");
  }
  if (Has(asked, kCommandWord) && options.generator.empty()) {
    throw UsageError(
        "--proposers command needs --generator \"COMMAND\", which generates the views; see docs/generators.md");
  }
  if (none && !options.generator.empty()) {
    throw UsageError("--generator is given, but --proposers none proposes nothing; say --proposers command");
  }
  RequireUtf8Command("--generator", options.generator);
}

}  // namespace oraclegs
