#include "oraclegs/run/stages.h"

#include <set>

#include "oraclegs/workspace/stage_records.h"
#include "run/proposing.h"

namespace oraclegs {
namespace {

using testing::UnorderedElementsAreArray;

/// The program's stages, with work that is only recorded.
std::vector<Stage> Noted() {
  std::vector<Stage> stages = Stages();
  for (Stage& stage : stages) {
    stage.work.wanted = [](const Run&) { return true; };
    stage.work.own = [](Run*, Fingerprint*) {};
    stage.work.undo = nullptr, stage.work.report = nullptr;
    stage.work.make = [](Run*, const std::string&) -> std::optional<nlohmann::json> {
      return nlohmann::json{{"files", nlohmann::json::array()}};
    };
    if (stage.work.load) stage.work.load = [](Run*) { return true; };
  }
  return stages;
}

/// The stage and those that need it, in turn.
std::set<std::string> Reached(const std::vector<Stage>& stages, const std::string& name) {
  std::set<std::string> reached = {name};
  for (const Stage& stage : stages) {  // they are in their order
    for (const std::string& need : stage.needs) {
      if (reached.count(need) > 0) reached.insert(stage.name);
    }
  }
  return reached;
}

/// Names of the stages whose records differ.
std::set<std::string> Changed(const nlohmann::json& before, const nlohmann::json& after) {
  std::set<std::string> changed;
  for (const auto& [name, record] : after.items()) {
    if (!before.contains(name) || before[name].value("key", "") != record.value("key", "")) changed.insert(name);
  }
  return changed;
}

class StagesTest : public ProposingTest {
 protected:
  nlohmann::json Records(const oraclegs::Run& run) const { return ReadStageRecords(run.workspace.root()); }
};

TEST_F(StagesTest, NeedOnlyWhatComesBefore) {
  std::set<std::string> before;
  for (const Stage& stage : Stages()) {
    for (const std::string& need : stage.needs) EXPECT_EQ(before.count(need), 1u) << stage.name << " " << need;
    before.insert(stage.name);
  }
  EXPECT_EQ(before.size(), 11u);
  EXPECT_EQ(Reached(Stages(), "register").size(), 10u) << "all but masks, which are read as files";
  EXPECT_THAT(Reached(Stages(), "proxies"),
              UnorderedElementsAreArray({"proxies", "propose", "validate", "train", "evaluate", "report"}));
}

TEST_F(StagesTest, ARaisedVersionRunsThatStageAndThoseThatNeedIt) {
  auto run = StartRun(Request("versions"), Silent());
  RunStage(&run, Noted(), "report");
  const nlohmann::json before = Records(run);
  EXPECT_EQ(before.size(), 10u);
  for (size_t s = 1; s < Stages().size(); ++s) {  // nothing needs masks
    std::vector<Stage> upgraded = Noted();
    ++upgraded[s].version;
    run.results = std::make_unique<StageResults>();
    RunStage(&run, upgraded, "report");
    EXPECT_EQ(Changed(before, Records(run)), Reached(upgraded, upgraded[s].name)) << upgraded[s].name;
    run.results = std::make_unique<StageResults>();
    RunStage(&run, Noted(), "report");  // back to where it was
    EXPECT_EQ(Changed(before, Records(run)), std::set<std::string>());
  }
}

TEST_F(StagesTest, AnUpgradedStereoTrainsAnew) {
  RunRequest request = Request("upgraded");
  request.options.propose.proposers = std::string("warp");
  const auto reconstruct = [&](const std::vector<Stage>& stages) {
    auto run = StartRun(request, recorder.AsListener());
    RunStage(&run, stages, "report");
    return Records(run);
  };
  const nlohmann::json before = reconstruct(Stages());
  EXPECT_EQ(Changed(before, reconstruct(Stages())), std::set<std::string>());
  std::vector<Stage> upgraded = Stages();
  upgraded[4].version = 99;
  ASSERT_EQ(upgraded[4].name, "depth");
  const nlohmann::json after = reconstruct(upgraded);
  EXPECT_THAT(Changed(before, after),
              UnorderedElementsAreArray({"depth", "propose", "validate", "train", "evaluate", "report"}));
  EXPECT_EQ(after.at("evaluate").at("test"), before.at("evaluate").at("test")) << "the same work has the same result";
}

}  // namespace
}  // namespace oraclegs
