#include "oraclegs/stages/stage_works.h"

#include "oraclegs/image/codecs.h"
#include "oraclegs/propose/proposal_files.h"
#include "run/proposing.h"
#include "support/errors.h"

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
  const StageResults& known = Bring(&run, "propose");
  std::vector<std::string> spare;
  for (const int v : SpareViews(run)) spare.push_back(FileName(run.scene.views[static_cast<size_t>(v)].name));
  ASSERT_EQ(spare.size(), 8u);  // 24 views, 4 of which test and 12 train
  EXPECT_EQ(Names(known.targets), spare);
  for (const int v : run.split.test) {
    const std::string test = FileName(run.scene.views[static_cast<size_t>(v)].name);
    EXPECT_THAT(Names(known.targets), testing::Not(Contains(test)));
    EXPECT_FALSE(fs::exists(run.workspace.proposals() / "warp" / (test + ".png")));
  }
  EXPECT_EQ(known.proxies.size(), 3u);
  for (const std::string& name : spare) {
    EXPECT_TRUE(fs::exists(run.workspace.proposals() / "warp" / (name + ".png")));
    EXPECT_TRUE(fs::exists(run.workspace.proposals() / "proxies" / (name + ".png")));
  }
  EXPECT_EQ(Names(ReadTargets(run.workspace.proposals())), spare);
}

TEST_F(ProposeStageTest, ReadsBackWhenNothingHasChanged) {
  auto first = StartRun(Request(), Silent());
  Bring(&first, "propose");
  const auto written = fs::last_write_time(first.workspace.proposals() / "warp");
  const nlohmann::json record = first.workspace.Record("propose");
  const std::vector<Target> targets = first.results->targets;
  first.results = std::make_unique<StageResults>();
  Bring(&first, "propose");
  EXPECT_EQ(first.workspace.Record("propose"), record);
  EXPECT_EQ(Names(first.results->targets), Names(targets));
  EXPECT_EQ(fs::last_write_time(first.workspace.proposals() / "warp"), written);
}

TEST_F(ProposeStageTest, KeepsTheProxyModelsWhenOnlyThePosesChange) {
  auto run = StartRun(Request("poses"), Silent());
  Bring(&run, "propose");
  const nlohmann::json first = run.workspace.Record("propose"), proxies = run.workspace.Record("proxies");
  run.options.trajectory.proposals = 5;
  EXPECT_EQ(Bring(&run, "propose").targets.size(), 5u);
  EXPECT_NE(run.workspace.Record("propose").at("key"), first.at("key"));
  EXPECT_EQ(run.workspace.Record("proxies"), proxies);
}

TEST_F(ProposeStageTest, AFinishedRunThatTrainsOnKeepsProxyModelsAndProposals) {
  RunRequest request = Request("longer");
  {
    auto run = StartRun(request, Silent());
    RunStage(&run, "train");
  }
  request.options.train.iterations = request.options.train.iterations.value() + 20;
  auto run = StartRun(request, recorder.AsListener());
  EXPECT_EQ(run.start_iterations, request.options.train.iterations.value() - 20);
  const auto records = [&] {
    return std::vector{run.workspace.Record("proxies"), run.workspace.Record("propose"),
                       run.workspace.Record("validate")};
  };
  const auto before = records();
  RunStage(&run, "train");
  EXPECT_EQ(records(), before);
  EXPECT_THAT(recorder.notes, Contains(HasSubstr("continuing from iteration 30 ")));
}

TEST_F(ProposeStageTest, MakesWarpsThatDoNotDependOnHowGaussiansStart) {
  RunRequest request = Request("warp_key");
  const auto key = [&](const std::string& proposers, double opacity) {
    request.options.propose.proposers = proposers;
    request.options.start.init_opacity = opacity;
    auto run = StartRun(request, Silent());
    return StageKey(&run, Stages(), "propose");
  };
  EXPECT_EQ(key("warp", 0.5), key("warp", 0.2));
  EXPECT_NE(key("proxies", 0.5), key("proxies", 0.2));
}

TEST_F(ProposeStageTest, TrainsOtherProxyModelsForAnotherSeed) {
  auto run = StartRun(Request("seed"), Silent());
  const std::string before = StageKey(&run, Stages(), "proxies");
  run.options.start.seed = 1;
  EXPECT_NE(StageKey(&run, Stages(), "proxies"), before);
}

TEST_F(ProposeStageTest, ProposesNothingUnlessAsked) {
  for (const bool none : {true, false}) {
    auto request = Request(none ? "none" : "zero");
    if (none) request.options.propose.proposers = std::string("none");
    if (!none) request.options.trajectory.proposals = 0;
    auto run = StartRun(request, recorder.AsListener());
    EXPECT_THAT(Bring(&run, "propose").targets, IsEmpty());
    EXPECT_THAT(StageKey(&run, Stages(), "propose"), IsEmpty());
    EXPECT_FALSE(fs::exists(run.workspace.proposals()));
  }
}

TEST_F(ProposeStageTest, SaysWhyNothingCanBeProposed) {
  auto run = StartRun(Request("poor"), recorder.AsListener());
  Bring(&run, "depth");
  run.results->geometry.points.resize(10);
  EXPECT_THAT(Bring(&run, "propose").targets, IsEmpty());
  EXPECT_THAT(recorder.warnings, Contains(HasSubstr("no views are proposed: 12 views with 10 dense points")));
  EXPECT_TRUE(run.workspace.Record("propose").is_null());
}

TEST_F(ProposeStageTest, TakesAFolderOfAnotherGenerator) {
  const fs::path folder = *temp / "folder" / "synthetic_7";
  auto request = Request("with_folder");
  request.options.propose.proposers = std::string("none");
  request.options.propose.proposal_folder = *temp / "folder";
  fs::create_directories(folder);
  auto run = StartRun(request, recorder.AsListener());
  const std::string name = fs::path(run.scene.views[static_cast<size_t>(SpareViews(run)[0])].name).filename();
  WritePng(folder / name, Image8{80, 60, 3, std::vector<uint8_t>(size_t{80} * 60 * 3, 90)});
  const StageResults& known = Bring(&run, "propose");
  ASSERT_EQ(known.folder.proposals.size(), 1u);
  EXPECT_THAT(known.targets, IsEmpty());
  const std::string before = StageKey(&run, Stages(), "propose");
  WritePng(folder / name, Image8{80, 60, 3, std::vector<uint8_t>(size_t{80} * 60 * 3, 91)});
  EXPECT_NE(StageKey(&run, Stages(), "propose"), before);
}

TEST_F(ProposeStageTest, HasACommandGenerateTheViews) {
  auto request = Request("command");
  request.options.propose.proposers = std::string("command");
  request.options.propose.generator = "cp {request}/warps/*.png {answer}";
  auto run = StartRun(request, recorder.AsListener());
  const std::vector<Target> targets = Bring(&run, "propose").targets;
  ASSERT_EQ(targets.size(), 8u);
  for (const Target& target : targets) {
    EXPECT_TRUE(fs::exists(run.workspace.proposals() / "command" / (target.name + ".png")));
    EXPECT_FALSE(fs::exists(run.workspace.proposals() / "warp" / (target.name + ".png")));
  }
  EXPECT_TRUE(run.results->proxies.empty());
  const auto candidates = run.results->candidates.Take(targets[0].name);
  ASSERT_TRUE(candidates);
  ASSERT_EQ(candidates->size(), 1u);
  EXPECT_EQ(candidates->front().source, "command");

  const std::string before = StageKey(&run, Stages(), "propose");
  run.options.generator_limits.generator_timeout = 7;
  EXPECT_EQ(StageKey(&run, Stages(), "propose"), before);
  run.options.propose.generator += " ";
  EXPECT_NE(StageKey(&run, Stages(), "propose"), before);
}

TEST_F(ProposeStageTest, AGeneratorThatFailsIsRunAgain) {
  auto request = Request("failing_command");
  request.options.propose.proposers = std::string("warp");
  request.options.propose.generator = "test -e " + (*temp / "ready").string() + " && cp {request}/warps/*.png {answer}";
  auto run = StartRun(request, Silent());
  EXPECT_THAT(MessageOf<RunError>([&] { Bring(&run, "propose"); }), HasSubstr("ended with exit code 1"));
  WriteFileAtomically(*temp / "ready", "");
  Bring(&run, "propose");
  const auto candidates = run.results->candidates.Take(run.results->targets[0].name);
  ASSERT_TRUE(candidates);
  ASSERT_EQ(candidates->size(), 2u);
  EXPECT_EQ(candidates->at(0).source, "warp");
  EXPECT_EQ(candidates->at(1).source, "command");
}

TEST_F(ProposeStageTest, RefusesAFolderThatIsNotThere) {
  auto request = Request("without_folder");
  request.options.propose.proposal_folder = *temp / "nowhere";
  EXPECT_THAT(MessageOf<InputError>([&] { StartRun(request, Silent()); }), HasSubstr("nowhere: is no folder"));
}

}  // namespace
}  // namespace oraclegs
