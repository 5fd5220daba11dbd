#include "oraclegs/stages/stage.h"

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/stages/metrics.h"
#include "oraclegs/stages/stage_clock.h"
#include "oraclegs/workspace/stage_records.h"
#include "run/fixtures.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> made, loaded, undone;  // by the stages below, which are plain functions

template <char kName>
struct Fake {
  static inline std::string input = "1";
  static inline bool wanted = true, readable = true;

  static Stage Row(std::vector<std::string> needs) {
    return {std::string(1, kName),
            1,
            std::move(needs),
            {.wanted = [](const Run&) { return wanted; },
             .own = [](Run*, Fingerprint* key) { key->Add(input); },
             .undo = [](Run*, const nlohmann::json&) { undone.push_back(std::string(1, kName)); },
             .make = [](Run*, const std::string&) -> std::optional<nlohmann::json> {
               made.push_back(std::string(1, kName));
               return nlohmann::json{{"files", nlohmann::json::array()}};
             },
             .load =
                 [](Run*) {
                   loaded.push_back(std::string(1, kName));
                   return readable;
                 }}};
  }
};

/// a <- b <- d, a <- c <- d.
class RunStageTest : public testing::Test {
 protected:
  RunStageTest() { Forget(); }
  ~RunStageTest() override { Fake<'b'>::input = "1", Fake<'b'>::wanted = true, Fake<'b'>::readable = true; }

  /// The workspace as another process would find it.
  void Forget() {
    made.clear(), loaded.clear(), undone.clear();
    run.results = std::make_unique<StageResults>();
  }

  TempDir temp;
  EventRecorder recorder;
  oraclegs::Run run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), recorder.AsListener());
  std::vector<Stage> stages = {Fake<'a'>::Row({}), Fake<'b'>::Row({"a"}), Fake<'c'>::Row({"a"}),
                               Fake<'d'>::Row({"b", "c"})};
};

TEST_F(RunStageTest, MakesWhatIsNeededOnceAndReadsItBack) {
  RunStage(&run, stages, "d");
  EXPECT_THAT(made, ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(recorder.started, ElementsAre("a", "b", "c", "d"));
  EXPECT_EQ(run.workspace.Record("c").at("key"), StageKey(&run, stages, "c"));
  EXPECT_GE(run.workspace.Record("c").at("seconds"), 0);
  EXPECT_GE(run.workspace.Record("c").at("cpu_seconds"), 0);
  EXPECT_TRUE(IsUpToDate(&run, stages, "d"));
  RunStage(&run, stages, "d");
  EXPECT_THAT(loaded, IsEmpty()) << "held in memory";
  Forget();
  RunStage(&run, stages, "d");
  EXPECT_THAT(made, IsEmpty());
  EXPECT_THAT(loaded, ElementsAre("a", "b", "c", "d"));
}

/// A stage of the smallest kind, with everything that a row says of it.
Stage ToyStage() {
  return {"toy",
          1,
          {"a"},
          {.wanted = [](const Run&) { return true; },
           .own = [](Run* run, Fingerprint* key) { key->Add(static_cast<double>(run->options.start.seed)); },
           .undo = [](Run* run, const nlohmann::json&) { std::filesystem::remove(run->workspace.root() / "toy.txt"); },
           .make = [](Run* run, const std::string&) -> std::optional<nlohmann::json> {
             WriteFileAtomically(run->workspace.root() / "toy.txt", "toy");
             return nlohmann::json{{"files", {"toy.txt"}}, {"letters", 3}};
           },
           .file = "toy.txt",
           .summary = [](const nlohmann::json& r) { return Counted(CountIn(r, "letters"), "letter"); },
           .seconds = [](const EstimateInput&) { return 1.; }}};
}

TEST_F(RunStageTest, TakesAnotherRowLikeItsOwn) {
  stages.push_back(ToyStage());
  RunStage(&run, stages, "toy");
  EXPECT_TRUE(std::filesystem::exists(temp / "out" / "toy.txt"));
  EXPECT_TRUE(IsUpToDate(&run, stages, "toy"));
  const nlohmann::json records = ReadStageRecords(temp / "out");
  EXPECT_THAT(StageTable({stages.back()}, nlohmann::json::object(), records), testing::HasSubstr("3 letters"));
  run.options.start.seed = 7;
  EXPECT_FALSE(IsUpToDate(&run, stages, "toy"));
}

TEST_F(RunStageTest, MakesAgainWhatItsInputsReach) {
  RunStage(&run, stages, "d");
  Forget();
  Fake<'b'>::input = "2";
  EXPECT_FALSE(IsUpToDate(&run, stages, "d"));
  EXPECT_TRUE(IsUpToDate(&run, stages, "c"));
  RunStage(&run, stages, "d");
  EXPECT_THAT(made, ElementsAre("b", "d"));
  EXPECT_THAT(undone, testing::UnorderedElementsAre("b", "d"));
}

TEST_F(RunStageTest, MakesAgainWhatCannotBeReadBack) {
  RunStage(&run, stages, "b");
  Forget();
  Fake<'b'>::readable = false;
  RunStage(&run, stages, "b");
  EXPECT_THAT(made, ElementsAre("b"));
  EXPECT_THAT(undone, ElementsAre("b"));
}

TEST_F(RunStageTest, MakesAgainWhatIsDamaged) {
  Stage& last = stages.back();
  last.work.load = nullptr;
  last.work.check = [](const oraclegs::Run&) { throw InputError("d.txt: is cut short; copy it again"); };
  RunStage(&run, stages, "d");
  Forget();
  RunStage(&run, stages, "d");
  EXPECT_THAT(made, ElementsAre("d"));
  EXPECT_THAT(recorder.warnings, testing::Contains("d.txt: is cut short; stage d is made again"));
}

TEST_F(RunStageTest, PassesOverStagesThatAreNotWanted) {
  RunStage(&run, stages, "d");
  const std::string before = StageKey(&run, stages, "d");
  Forget();
  Fake<'b'>::wanted = false;
  EXPECT_EQ(StageKey(&run, stages, "b"), "");
  EXPECT_NE(StageKey(&run, stages, "d"), before);
  RunStage(&run, stages, "d");
  EXPECT_THAT(made, ElementsAre("d"));
  EXPECT_TRUE(run.workspace.Record("b").is_null());
}

TEST_F(RunStageTest, RunsAloneOnWhatThereIs) {
  RunStage(&run, stages, "b");
  Forget();
  Fake<'b'>::input = "2";
  RunStageAlone(&run, stages, "d");
  EXPECT_THAT(made, ElementsAre("d")) << "b stays as it is, and c is not there";
}

TEST_F(RunStageTest, NotesThatAResultIsKept) {
  Stage& last = stages.back();
  last.work.load = nullptr, last.work.file = "d.txt";
  RunStage(&run, stages, "d");
  recorder = {};
  RunStage(&run, stages, "d");
  EXPECT_THAT(recorder.notes, ElementsAre("d: nothing has changed, d.txt is kept"));
  EXPECT_THAT(recorder.started, IsEmpty());
}

TEST(StageClock, ReportsBeginningAndEnd) {
  std::vector<std::string> reported;
  const Listener listener = [&](const Event& event) {
    if (const auto* s = std::get_if<StageStarted>(&event)) reported.push_back("start " + s->stage);
    if (const auto* f = std::get_if<StageFinished>(&event)) reported.push_back("end " + f->stage);
  };
  const StageClock clock("x", listener);
  EXPECT_GE(clock.Finish(), 0);
  EXPECT_THAT(reported, testing::ElementsAre("start x", "end x"));
}

}  // namespace
}  // namespace oraclegs
