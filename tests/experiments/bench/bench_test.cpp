#include "oraclegs/experiments/bench/bench.h"

#include <gmock/gmock.h>

#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "experiments/bench/small_bench.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/experiments/bench/run_record.h"
#include "support/errors.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

/// As if the program were killed.
struct Killed {};

/// Writes what runs would write; may be killed at any point of it.
class FakeLauncher : public Launcher {
 public:
  void Run(const std::vector<Job>& jobs, const std::function<void(size_t, const JobResult&)>& ended,
           const Listener&) override {
    waves.emplace_back();
    for (size_t j = 0; j < jobs.size(); ++j) {
      waves.back().push_back(jobs[j].name);
      if (before_each) before_each();
      const fs::path workspace = jobs[j].command.at(4);
      EXPECT_FALSE(fs::exists(workspace / "metrics.json")) << jobs[j].name << " is done";
      DieAt(0);
      fs::create_directories(workspace / "checkpoints");
      DieAt(1);
      JobResult result{.seconds = 2, .peak_bytes = 5'000'000'000, .why = ""};
      if (failing.count(jobs[j].name) > 0) {
        result.end = JobEnd::kFailed, result.why = "oraclegs: error: no points";
      } else if (cancelled.count(jobs[j].name) > 0) {
        result.end = JobEnd::kCancelled, result.why = "was ended";
      } else {
        WriteText(workspace / "metrics.json",
                  R"({"test": {"psnr": 20, "ssim": 0.5}, "gaussians": 10, "peak_memory_bytes": 1000})");
        ++scored[jobs[j].name];
      }
      DieAt(2);
      ended(j, result);
      DieAt(3);
    }
  }

  std::set<std::string> failing, cancelled;
  std::map<std::string, int> scored;
  std::vector<std::vector<std::string>> waves;
  std::function<void()> before_each;
  int kill_in = -1;       ///< places until it is killed
  std::set<int> kill_at;  ///< kinds of places

 private:
  void DieAt(int place) {
    if (kill_in >= 0 && kill_at.count(place) > 0 && kill_in-- == 0) throw Killed();
  }
};

class BenchTest : public SmallBenchTest {
 protected:
  BenchReport Run(const BenchRequest& request) {
    return RunBench(request, PlanBench(request), &launcher, recorder.AsListener());
  }
  json Saved() const { return json::parse(ReadFile(dir / "out/bench.json")); }

  FakeLauncher launcher;
  EventRecorder recorder;
};

TEST_F(BenchTest, RunsAllAndWritesItsFiles) {
  const BenchReport report = Run(Request());
  EXPECT_EQ(launcher.scored.size(), 16u);
  for (const BenchScore& run : report.runs) {
    EXPECT_TRUE(run.is_scored());
    EXPECT_EQ(*run.value[static_cast<size_t>(BenchValue::kPeakBytes)], 5e9) << "the launcher saw more";
    EXPECT_FALSE(fs::exists(dir / "out" / run.workspace / "checkpoints"));
  }
  for (const char* file : {"bench.json", "bench.md", "bench.tex", "bench.csv", "bench-views.svg", "bench-time.svg"}) {
    EXPECT_TRUE(fs::exists(dir / "out" / file)) << file;
  }
  EXPECT_EQ(Saved().at("runs").size(), 16u);
  EXPECT_THAT(recorder.notes, Contains(AllOf(HasSubstr("run 4 of 16 ("), HasSubstr("20.00 dB, about 0:24 left"))));
}

TEST_F(BenchTest, FirstOfEachSceneViewsAndSeedRunsBeforeTheOthers) {
  BenchRequest request = Request();
  request.options.methods = "3dgs-mcmc-random,ours,ours-no-proposals", request.options.views = "3",
  request.options.seeds = 1;
  Run(request);
  ASSERT_EQ(launcher.waves.size(), 2u);
  const std::string suite = PlanBench(request).suite.name;
  EXPECT_THAT(launcher.waves[0], testing::ElementsAre(suite + "-one-3-ours-seed0", suite + "-two-3-ours-seed0"))
      << "the first that computes depth";
  EXPECT_EQ(launcher.waves[1].size(), 4u);
}

TEST_F(BenchTest, KilledAnywhereItLosesNothingAndRepeatsNothing) {
  std::mt19937 random(7);
  int kills = 0;
  for (int round = 0; round < 10; ++round) {
    launcher.kill_at = {static_cast<int>(random() % 4)};
    launcher.kill_in = static_cast<int>(random() % 3);
    try {
      Run(Request());
    } catch (const Killed&) {
      ++kills;
    }
  }
  launcher.kill_in = -1;
  const BenchReport report = Run(Request());
  EXPECT_GE(kills, 5);
  EXPECT_EQ(launcher.scored.size(), 16u);
  for (const auto& [name, count] : launcher.scored) EXPECT_EQ(count, 1) << name;
  for (const BenchScore& run : report.runs) EXPECT_TRUE(run.is_scored());
  const size_t waves = launcher.waves.size();
  const json before = Saved();
  Run(Request());
  EXPECT_EQ(launcher.waves.size(), waves) << "nothing is left to run";
  EXPECT_EQ(Saved(), before);
}

/// Two runs of scene "one", the first of which has scores and geometry.
class SecondWaveTest : public BenchTest {
 protected:
  SecondWaveTest() {
    request_ = Request();
    request_.options.suite = (*scenes / "one").string(), request_.options.views = "3", request_.options.seeds = 1;
    const BenchPlan plan = PlanBench(request_);
    leader_ = plan.runs[0].name, follower_ = plan.runs[1].name;
    WriteText(dir / "out/bench.json", R"({"program": "oraclegs"})");
    WriteText(RunFile(leader_, "options.json"), Said(R"({})"));
    WriteText(RunFile(leader_, "sfm/points.bin"), "points");
    WriteText(RunFile(leader_, "stages.json"),
              R"({"sfm": {"key": "1", "files": ["sfm/points.bin"]}, "depth": {"key": "2", "files": []}})");
    WriteText(RunFile(leader_, "metrics.json"), R"({"test": {"psnr": 20}, "gaussians": 10})");
    WriteRunRecord(dir / "out/runs" / leader_,
                   {(*scenes / "one").string(), ResultArguments(plan.runs[0].arguments), "test", true, {}});
  }
  /// options.json of a run of the scene.
  static std::string Said(const char* options) {
    return fmt::format(R"({{"program": "oraclegs", "format": 1, "scene": "{}", "options": {}, "size": {{"a": 1}}}})",
                       (*scenes / "one").string(), options);
  }
  fs::path RunFile(const std::string& run, const char* file) const { return dir / "out/runs" / run / file; }

  BenchRequest request_;
  std::string leader_, follower_;
};

TEST_F(SecondWaveTest, TakesTheGeometryOfTheFirst) {
  launcher.before_each = [&] { EXPECT_EQ(ReadFile(RunFile(follower_, "sfm/points.bin")), "points"); };
  Run(request_);
  EXPECT_EQ(launcher.waves, (std::vector<std::vector<std::string>>{{follower_}}));
}

TEST_F(SecondWaveTest, ARunThatStillWorksIsLeftToTheLauncher) {
  fs::create_directories(dir / "out/runs" / follower_);
  const FolderLock at_work(dir / "out/runs" / follower_);
  const BenchReport report = Run(request_);
  EXPECT_EQ(launcher.waves, (std::vector<std::vector<std::string>>{{follower_}}));
  EXPECT_TRUE(report.runs[1].is_scored()) << report.runs[1].failure;
  EXPECT_FALSE(fs::exists(RunFile(follower_, "sfm"))) << "nothing is written where another works";
}

TEST_F(SecondWaveTest, WhatAnInterruptedRunSaidOfItselfStands) {
  // As --allow-fallback leaves it: options that are not those asked for, and what auto became.
  const std::string said = Said(R"({"proposers": "warp"})");
  WriteText(RunFile(follower_, "options.json"), said);
  WriteText(RunFile(follower_, "checkpoints/000010.bin"), "half");
  launcher.before_each = [&] { EXPECT_EQ(ReadFile(RunFile(follower_, "options.json")), said); };
  const BenchReport report = Run(request_);
  EXPECT_TRUE(report.runs[1].is_scored()) << report.runs[1].failure;
  EXPECT_EQ(launcher.scored[follower_], 1);
}

TEST_F(SecondWaveTest, WhatHasGeometryOfItsOwnIsNotClaimed) {
  const std::string said = Said(R"({})");
  WriteText(RunFile(follower_, "options.json"), said);
  WriteText(RunFile(follower_, "sfm/points.bin"), "own");
  launcher.before_each = [&] {
    EXPECT_EQ(ReadFile(RunFile(follower_, "options.json")), said);
    EXPECT_EQ(ReadFile(RunFile(follower_, "sfm/points.bin")), "own");
  };
  Run(request_);
  EXPECT_EQ(launcher.scored[follower_], 1);
}

TEST_F(SecondWaveTest, WhoNeedsDepthWaitsForIt) {
  request_.options.methods = "3dgs-mcmc-random,ours,ours-no-proposals";
  const std::string random = PlanBench(request_).runs[0].name;
  fs::rename(dir / "out/runs" / leader_, dir / "out/runs" / random);
  fs::remove(RecordFile(dir / "out/runs" / leader_));
  WriteRunRecord(
      dir / "out/runs" / random,
      {(*scenes / "one").string(), ResultArguments(PlanBench(request_).runs[0].arguments), "test", true, {}});
  WriteText(RunFile(random, "stages.json"), R"({"sfm": {"key": "1", "files": ["sfm/points.bin"]}})");
  Run(request_);
  ASSERT_EQ(launcher.waves.size(), 2u) << "structure from motion alone is not what they wait for";
  EXPECT_EQ(launcher.waves[0], std::vector<std::string>{leader_});
}

TEST_F(SecondWaveTest, TellsOfRunsOfAnotherVersion) {
  request_.version = "newer";
  const BenchReport report = Run(request_);
  EXPECT_THAT(report.notes, Contains(HasSubstr("different versions")));
  EXPECT_EQ(report.runs[0].version, "test");
  EXPECT_EQ(report.runs[1].version, "newer");
}

TEST_F(BenchTest, TheTimeLeftIsThatOfAllWorkers) {
  BenchRequest request = Request();
  request.workers = 4;
  Run(request);
  EXPECT_THAT(recorder.notes, Contains(AllOf(HasSubstr("run 4 of 16 ("), HasSubstr("about 0:06 left"))));
  fs::remove_all(dir / "out");
  recorder.notes.clear();
  request.workers = 0;
  Run(request);
  EXPECT_THAT(recorder.notes, testing::Not(Contains(HasSubstr(" left")))) << "nobody knows of a queue";
}

TEST_F(BenchTest, ScenesWithNamesThatAreNotUtf8AreFoundAgain) {
  const std::string name = "caf\xe9";
  fs::create_directories(dir / "odd");
  fs::copy(*scenes / "one", dir / "odd" / name, fs::copy_options::recursive);
  BenchRequest request = Request();
  request.options.suite = (dir / "odd").string(), request.options.views = "3";
  Run(request);
  const size_t waves = launcher.waves.size();
  Run(request);
  EXPECT_EQ(launcher.waves.size(), waves) << "all are done";
  EXPECT_EQ(launcher.scored.size(), 4u);
}

TEST_F(BenchTest, FailuresAreRowsAndAreTriedAgain) {
  const std::string name = PlanBench(Request()).suite.name + "-two-5-ours-seed1";
  launcher.failing = {name};
  BenchReport report = Run(Request());
  const auto failed =
      std::find_if(report.runs.begin(), report.runs.end(), [](const auto& r) { return !r.is_scored(); });
  ASSERT_NE(failed, report.runs.end());
  EXPECT_EQ(failed->failure, "no points");
  EXPECT_EQ(failed->scene + std::to_string(failed->views) + failed->method, "two5ours");
  launcher.failing.clear();
  report = Run(Request());
  EXPECT_EQ(launcher.waves.back(), std::vector<std::string>{name});
  EXPECT_TRUE(std::all_of(report.runs.begin(), report.runs.end(), [](const auto& r) { return r.is_scored(); }));
}

TEST_F(BenchTest, CancelledRunsAreNoFailures) {
  const std::string name = PlanBench(Request()).suite.name + "-one-3-ours-seed0";
  launcher.cancelled = {name};
  const BenchReport report = Run(Request());
  EXPECT_FALSE(report.runs[0].ended);
  EXPECT_EQ(report.runs[0].failure, "");
}

TEST_F(BenchTest, NothingScoredIsAnError) {
  const BenchPlan plan = PlanBench(Request());
  for (const BenchRun& run : plan.runs) launcher.failing.insert(run.name);
  EXPECT_THAT(MessageOf<RunError>([&] { Run(Request()); }),
              AllOf(HasSubstr("nothing was scored"), HasSubstr("no points")));
}

TEST_F(BenchTest, AMissingSceneIsARow) {
  BenchRequest request = Request();
  request.options.views = "3,9";
  const BenchReport report = Run(request);
  EXPECT_EQ(launcher.scored.size(), 8u);
  EXPECT_THAT(report.runs.back().failure, HasSubstr("--views asks for 9"));
}

TEST_F(BenchTest, RunsOfOtherOptionsAreRefused) {
  Run(Request());
  BenchRequest request = Request();
  request.asked = {{"iterations", "60"}};
  EXPECT_THAT(MessageOf<InputError>([&] { Run(request); }),
              AllOf(HasSubstr("--iterations was 50, now is 60"), HasSubstr("--overwrite")));
  request.asked = {{"iterations", "50"}, {"threads", "1"}};
  Run(request);  // it changes no result
  request.asked = {{"iterations", "60"}};
  request.overwrite = true;
  for (const auto& entry : fs::directory_iterator(dir / "out/runs")) {
    if (entry.is_directory()) WriteText(entry.path() / "options.json", R"({"program": "oraclegs"})");  // a workspace
  }
  Run(request);
  EXPECT_EQ(launcher.scored.begin()->second, 2);
}

TEST_F(BenchTest, AFolderOfOthersIsRefused) {
  WriteText(dir / "out/thesis.txt", "mine");
  EXPECT_THAT(MessageOf<InputError>([&] { Run(Request()); }), HasSubstr("holds no benchmark"));
  BenchRequest request = Request();
  request.out = *scenes / "one/out";
  EXPECT_THROW(Run(request), InputError) << "in the scene";
}

TEST_F(BenchTest, WhatCannotBeWrittenEndsItAndKeepsWhatWasMeasured) {
  launcher.before_each = [&, runs = 0]() mutable {
    if (++runs == 3) fs::remove(dir / "out/bench.csv"), WriteText(dir / "out/bench.csv/in/the/way", "");
  };
  EXPECT_THROW(Run(Request()), RunError);
  EXPECT_EQ(launcher.scored.size(), 3u);
  launcher.before_each = {};
  fs::remove_all(dir / "out/bench.csv");
  Run(Request());
  EXPECT_EQ(launcher.scored.size(), 16u);
  for (const auto& [name, count] : launcher.scored) EXPECT_EQ(count, 1) << name;
}

}  // namespace
}  // namespace oraclegs
