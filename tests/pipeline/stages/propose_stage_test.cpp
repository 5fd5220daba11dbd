#include "oraclegs/pipeline/stages/propose_stage.h"

#include "oraclegs/propose/proposal_files.h"
#include "pipeline/proposing.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

using ProposeStageTest = ProposingTest;

std::vector<std::string> Names(const std::vector<Target>& targets) {
  std::vector<std::string> names;
  for (const Target& target : targets) names.push_back(target.name);
  return names;
}

TEST_F(ProposeStageTest, ProposesFromSparePosesAndNeverFromTestPoses) {
  auto run = StartRun(Request(), recorder.AsListener());
  const Preparation prepared = Prepare(&run);
  const ProposalPlan plan = Propose(&run, prepared);
  std::vector<std::string> spare;
  for (const int v : SpareViews(run)) spare.push_back(FileName(run.scene.views[static_cast<size_t>(v)].name));
  ASSERT_EQ(spare.size(), 8u);  // 24 photographs, 4 of which test and 12 train
  EXPECT_EQ(Names(plan.targets), spare);
  for (const int v : run.split.test) {
    const std::string test = FileName(run.scene.views[static_cast<size_t>(v)].name);
    EXPECT_THAT(Names(plan.targets), testing::Not(Contains(test)));
    EXPECT_FALSE(fs::exists(run.workspace.proposals() / "warp" / (test + ".png")));
  }
  EXPECT_EQ(plan.opinions.size(), 3u);
  for (const std::string& name : spare) {
    EXPECT_TRUE(fs::exists(run.workspace.proposals() / "warp" / (name + ".png")));
    EXPECT_TRUE(fs::exists(run.workspace.proposals() / "splat" / (name + ".png")));
  }
  EXPECT_EQ(Names(ReadTargets(run.workspace.proposals())), spare);
}

TEST_F(ProposeStageTest, IsSkippedWhenNothingHasChanged) {
  auto run = StartRun(Request(), recorder.AsListener());
  const Preparation prepared = Prepare(&run);
  const ProposalPlan first = Propose(&run, prepared);
  const auto written = fs::last_write_time(run.workspace.proposals() / "opinions" / "0.ply");
  const ProposalPlan again = Propose(&run, prepared);
  EXPECT_EQ(again.key, first.key);
  EXPECT_EQ(Names(again.targets), Names(first.targets));
  EXPECT_EQ(fs::last_write_time(run.workspace.proposals() / "opinions" / "0.ply"), written);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(torch::equal(again.opinions[k].gaussians.means, first.opinions[k].gaussians.means));
  }
}

TEST_F(ProposeStageTest, KeepsTheQuickModelsWhenOnlyThePosesAreOthers) {
  auto run = StartRun(Request("poses"), Silent());
  const Preparation prepared = Prepare(&run);
  const ProposalPlan first = Propose(&run, prepared);
  const auto written = fs::last_write_time(run.workspace.proposals() / "opinions" / "0.ply");
  run.options.trajectory.proposals = 5;
  const ProposalPlan fewer = Propose(&run, prepared);
  EXPECT_NE(fewer.key, first.key);
  EXPECT_EQ(fewer.targets.size(), 5u);
  EXPECT_EQ(fewer.opinions.size(), first.opinions.size());
  EXPECT_EQ(fs::last_write_time(run.workspace.proposals() / "opinions" / "0.ply"), written);
}

TEST_F(ProposeStageTest, WarpsDoNotDependOnHowGaussiansStart) {
  RunRequest request = Request("warp_key");
  request.options.propose.proposers = "warp";
  auto run = StartRun(request, Silent());
  const Preparation prepared = Prepare(&run);
  const std::string before = Propose(&run, prepared).key;
  run.options.start.init_opacity = 0.2;
  EXPECT_EQ(Propose(&run, prepared).key, before);
  run.options.propose.proposers = "splat";
  const std::string splat = Propose(&run, prepared).key;
  run.options.start.init_opacity = 0.5;
  EXPECT_NE(Propose(&run, prepared).key, splat);
}

TEST_F(ProposeStageTest, MakesOtherOpinionsForAnotherSeed) {
  auto request = Request("seed");
  auto run = StartRun(request, Silent());
  const std::string before = Propose(&run, Prepare(&run)).key;
  run.options.start.seed = 1;
  EXPECT_NE(Propose(&run, Prepare(&run)).key, before);
}

TEST_F(ProposeStageTest, ProposesNothingWhenNotAskedTo) {
  for (const bool none : {true, false}) {
    auto request = Request(none ? "none" : "zero");
    if (none) request.options.propose.proposers = "none";
    if (!none) request.options.trajectory.proposals = 0;
    auto run = StartRun(request, recorder.AsListener());
    const ProposalPlan plan = Propose(&run, Prepare(&run));
    EXPECT_THAT(plan.key, IsEmpty());
    EXPECT_THAT(plan.targets, IsEmpty());
    EXPECT_FALSE(fs::exists(run.workspace.proposals()));
  }
}

TEST_F(ProposeStageTest, SaysWhyNothingCanBeProposed) {
  auto run = StartRun(Request("poor"), recorder.AsListener());
  Preparation prepared = Prepare(&run);
  prepared.geometry.points.resize(10);
  EXPECT_THAT(Propose(&run, prepared).targets, IsEmpty());
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("no views are proposed: 12 photographs with 10 dense points")));
}

TEST_F(ProposeStageTest, TakesAFolderOfAnotherGenerator) {
  const fs::path folder = *temp / "folder" / "synthetic_7";
  auto request = Request("with_folder");
  request.options.propose.proposers = "none";
  request.options.propose.proposal_folder = *temp / "folder";
  fs::create_directories(folder);
  auto run = StartRun(request, recorder.AsListener());
  const std::string name = fs::path(run.scene.views[static_cast<size_t>(SpareViews(run)[0])].name).filename();
  WritePng(folder / name, Image8{80, 60, 3, std::vector<uint8_t>(size_t{80} * 60 * 3, 90)});
  const ProposalPlan plan = Propose(&run, Prepare(&run));
  ASSERT_EQ(plan.folder.proposals.size(), 1u);
  EXPECT_THAT(plan.targets, IsEmpty());
  WritePng(folder / name, Image8{80, 60, 3, std::vector<uint8_t>(size_t{80} * 60 * 3, 91)});
  EXPECT_NE(Propose(&run, Prepare(&run)).key, plan.key);
}

TEST_F(ProposeStageTest, AFolderThatIsNotThereIsBadInput) {
  auto request = Request("without_folder");
  request.options.propose.proposal_folder = *temp / "nowhere";
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }), HasSubstr("nowhere: is no folder"));
}

}  // namespace
}  // namespace oraclegs
