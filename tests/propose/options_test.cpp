#include "oraclegs/propose/options.h"

#include <gmock/gmock.h>

#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

ProposeOptions Asking(const std::string& words, const std::string& generator = "") {
  ProposeOptions options;
  options.proposers = words, options.generator = generator;
  return options;
}

std::string Refusal(const ProposeOptions& options) {
  return MessageOf<UsageError>([&] { CheckProposers(options); });
}

TEST(ProposeOptions, ListWordsInTheirOrder) {
  EXPECT_THAT(ProposeOptions().Words(), ElementsAre("proxies"));
  EXPECT_THAT(Asking("seva, warp").Words(), ElementsAre("seva", "warp"));
  EXPECT_THAT(Asking("none").Words(), IsEmpty());
  EXPECT_TRUE(Asking("seva,warp").Uses("warp"));
  EXPECT_FALSE(Asking("seva,warp").Uses("proxies"));
}

TEST(ProposeOptions, AddTheCommandOfAGeneratorToOthers) {
  EXPECT_THAT(Asking("warp", "paint").Words(), ElementsAre("warp", "command"));
  EXPECT_THAT(Asking("command", "paint").Words(), ElementsAre("command"));
  EXPECT_THAT(Asking("none", "paint").Words(), IsEmpty());
}

TEST(ProposeOptions, KnowWhetherProxyModelsProposeAlone) {
  EXPECT_TRUE(ProposeOptions().ByProxiesAlone());
  EXPECT_FALSE(Asking("proxies,warp").ByProxiesAlone());
  EXPECT_FALSE(Asking("proxies", "paint").ByProxiesAlone());
  ProposeOptions with_folder;
  with_folder.proposal_folder = "/somewhere";
  EXPECT_FALSE(with_folder.ByProxiesAlone());
}

TEST(CheckProposers, RefusesWordsThatNothingHas) {
  for (const char* good : {"proxies", "warp,proxies", "none"}) EXPECT_EQ(Refusal(Asking(good)), "") << good;
  EXPECT_EQ(Refusal({}), "");
  EXPECT_EQ(Refusal(Asking("proxies,wrap")),
            "--proposers is 'proxies,wrap', must be auto, none, or of the words: proxies, warp, seva, command; did you "
            "mean 'warp'?");
  EXPECT_THAT(Refusal(Asking("splat")), AllOf(HasSubstr("'splat'"), EndsWith("seva, command")));
  for (const char* bad : {"", ",", "none,warp", "auto,warp"}) {
    EXPECT_THAT(Refusal(Asking(bad)), HasSubstr("must be auto, none, or of the words")) << bad;
  }
}

TEST(CheckProposers, WantsGeneratorAndCommandTogether) {
  EXPECT_THAT(Refusal(Asking("warp,command")), HasSubstr("--proposers command needs --generator"));
  EXPECT_THAT(Refusal(Asking("none", "paint")), HasSubstr("say --proposers command"));
  EXPECT_EQ(Refusal(Asking("proxies,command", "paint")), "");
}

TEST(ProposersHelp, ExplainsEachWord) {
  for (const std::string& word : ProposerWords()) EXPECT_THAT(ProposersHelp(), HasSubstr(word + " = "));
}

}  // namespace
}  // namespace oraclegs
