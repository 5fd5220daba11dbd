#include "oraclegs/stages/proposer_row.h"

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/proposers/proposer_rows.h"
#include "run/proposing.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

class ProposerRowTest : public ProposingTest {
 protected:
  /// Sources of the candidates at the first training view: as a new pose, and held out.
  static std::vector<std::string> Sources(oraclegs::Run* run, std::optional<int> held_out) {
    run->results->proposers = nullptr;
    const auto candidates = ProposersOf(run).Ask({{"view", ViewsOf(run).views[0].camera}}, {held_out});
    std::vector<std::string> sources;
    for (const Proposal& p : candidates[0]) sources.push_back(p.source);
    return sources;
  }
};

TEST_F(ProposerRowTest, AsksTheRowsThatAreWanted) {
  auto run = StartRun(Request(), Silent());
  Bring(&run, "depth");
  const Gaussians blob = InitializeGaussians(ToPointCloud(std::vector<ScenePoint>(4)), {1, 0.5});
  const auto use = [&](const std::string& choice, bool has_proxies) {
    run.options.propose.proposers = choice;
    run.results->proxies.clear();
    if (has_proxies) run.results->proxies.push_back({blob.Clone(), blob.Clone(), {0}});
  };
  use("proxies,warp", true);
  EXPECT_THAT(Sources(&run, std::nullopt), ElementsAre("warp", "proxies"));
  EXPECT_THAT(Sources(&run, 0), ElementsAre("warp", "proxies"));
  use("proxies", true);
  EXPECT_THAT(Sources(&run, std::nullopt), ElementsAre("proxies"));
  use("proxies", false);
  EXPECT_THAT(Sources(&run, std::nullopt), ElementsAre("warp")) << "stands in for models that could not be trained";
  use("seva", false);
  EXPECT_TRUE(AsksGenerator(run));
  EXPECT_THAT(Sources(&run, 0), ElementsAre("warp")) << "teaches the oracle";
  EXPECT_TRUE(Sources(&run, std::nullopt).empty()) << "nothing was generated, and warp does not paint";
}

/// A proposer of the smallest kind: one row, one class.
class GrayProposer : public Proposer {
 public:
  std::string name() const override { return "gray"; }
  std::optional<Proposal> Propose(const Target& target, std::optional<int> held_out) const override {
    if (held_out) return std::nullopt;
    const int w = target.camera.width, h = target.camera.height;
    return Proposal{
        target.name, "gray", target.camera, {w, h, 3, std::vector<float>(static_cast<size_t>(w) * h * 3, 0.5f)}};
  }
};

TEST_F(ProposerRowTest, RunsAnotherRowLikeItsOwn) {
  RunRequest request = Request("toy");
  request.options.propose.proposers = std::string("warp");
  auto run = StartRun(request, Silent());
  std::vector<ProposerRow> rows = ProposerRows();
  rows.push_back(
      {.word = "gray",
       .sees_anything = true,
       .own = [](const oraclegs::Run&, Fingerprint* key) { key->Add("gray 1"); },
       .make =
           [](const oraclegs::Run&, const Warper&) {
             std::vector<AskedProposer> members;
             members.push_back({std::make_unique<GrayProposer>()});
             return members;
           },
       .undo = [](const std::filesystem::path& proposals) { std::filesystem::remove_all(proposals / "gray"); }});
  run.proposer_rows = &rows, run.options.propose.proposers = std::string("warp,gray");
  const StageResults& results = Bring(&run, "validate");
  EXPECT_FALSE(results.targets.empty());
  for (const Target& target : results.targets) {
    EXPECT_TRUE(std::filesystem::exists(*temp / "toy" / "proposals" / "gray" / (target.name + ".png")));
  }
}

}  // namespace
}  // namespace oraclegs
