#include "oraclegs/experiments/bench/run_record.h"
#include "experiments/bench/small_bench.h"
#include "experiments/launch/fake_slurm.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/experiments/launch/slurm_launcher.h"
#include "support/errors.h"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>

#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(RunRecord, ReadsWhatItWrote) {
  const TempDir dir;
  const auto workspace = dir / "suite-v1.5-12-ours-seed0";
  EXPECT_FALSE(ReadRunRecord(workspace));
  RunRecord record{"/data/v1.5", {{"views", "12"}}, "1.0", true, {}};
  record.result.seconds = 2.5, record.result.peak_bytes = 12345, record.result.why = "no";
  WriteRunRecord(workspace, record);
  EXPECT_TRUE(std::filesystem::exists(dir / "suite-v1.5-12-ours-seed0.json"));
  const auto read = ReadRunRecord(workspace);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene, record.scene);
  EXPECT_EQ(read->arguments, record.arguments);
  EXPECT_TRUE(read->ended);
  EXPECT_EQ(read->result.seconds, 2.5);
  EXPECT_EQ(read->result.peak_bytes, 12345);
  EXPECT_EQ(read->result.why, "no");
}

TEST(RunRecord, TextsThatAreNotUtf8AreReadBackAsRecorded) {
  const TempDir dir;
  const std::string scene = "/data/caf\xe9";
  WriteRunRecord(dir / "run", {scene, {{"images", "\xff"}}, "1.0", true, {}});
  const auto read = ReadRunRecord(dir / "run");
  ASSERT_TRUE(read);
  EXPECT_NE(read->scene, scene);
  EXPECT_EQ(read->scene, AsRecorded(scene).get<std::string>());
  EXPECT_EQ(read->arguments, AsRecorded({{"images", "\xff"}}));
}

TEST(RunRecord, DamagedFilesAreNone) {
  const TempDir dir;
  for (const char* text : {"", "{", "[]", R"({"program": "other"})", R"({"program": "oraclegs", "options": 3})"}) {
    WriteText(RecordFile(dir / "run"), text);
    EXPECT_FALSE(ReadRunRecord(dir / "run")) << text;
  }
}

TEST(ReadScore, TakesWhatTheRunMeasured) {
  const TempDir dir;
  WriteText(dir / "run/metrics.json",
            R"({"test": {"psnr": 20.5, "ssim": 0.5, "lpips": 0.3, "conventions": {"lpips": "VGG16, as is"}},
                "gaussians": 100, "peak_memory_bytes": 2000, "views": {"train": 12}, "train": {"seconds": 3},
                "stages": {"sfm": {"seconds": 1, "cpu_seconds": 2}, "train": {"seconds": 4, "cpu_seconds": 7},
                           "evaluate": {"seconds": 10}}})");
  BenchScore score;
  ASSERT_TRUE(ReadScore(dir / "run", &score));
  EXPECT_TRUE(score.is_scored());
  EXPECT_THAT(score.value, testing::ElementsAre(20.5, 0.5, 0.3, 5.0, 9.0, 2000.0, 100.0)) << "seconds without scoring";
  EXPECT_EQ(score.training_seconds, 3);
  EXPECT_EQ(score.train_views, 12u);
  EXPECT_EQ(score.lpips, "VGG16, as is");
}

TEST(ReadScore, CpuTimeIsUnknownWhereAStageHasNone) {
  const TempDir dir;
  const auto cpu_seconds = [&](const char* train) {
    WriteText(dir / "run/metrics.json", fmt::format(R"({{"test": {{"psnr": 20}}, "gaussians": 1,
                              "stages": {{"sfm": {{"seconds": 1, "cpu_seconds": 2}}, "train": {}}}}})",
                                                    train));
    BenchScore score;
    EXPECT_TRUE(ReadScore(dir / "run", &score));
    return score.value[static_cast<size_t>(BenchValue::kCpuSeconds)];
  };
  EXPECT_EQ(cpu_seconds(R"({"seconds": 4, "cpu_seconds": 3})"), 5);
  EXPECT_EQ(cpu_seconds(R"({"seconds": 4, "cpu_seconds": null})"), std::nullopt);
  EXPECT_EQ(cpu_seconds(R"({"seconds": 4})"), std::nullopt);
}

TEST(ReadScore, IncompleteIsNotDone) {
  const TempDir dir;
  BenchScore score;
  EXPECT_FALSE(ReadScore(dir / "run", &score));
  for (const char* text : {"", "{}", R"({"test": {"psnr": 3)", R"({"test": 3, "gaussians": 1})", R"({"test": {}})"}) {
    WriteText(dir / "run/metrics.json", text);
    EXPECT_FALSE(ReadScore(dir / "run", &score)) << text;
    EXPECT_FALSE(score.ended);
  }
}

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// The first run of the plan has a workspace.
class RemoveRunsTest : public SmallBenchTest {
 protected:
  RemoveRunsTest() : request_(Request()), plan_(PlanBench(request_)), workspace_(WorkspaceOf(request_, plan_.runs[0])) {
    WriteText(workspace_ / "options.json", R"({"program": "oraclegs"})");
    WriteText(workspace_ / "sfm/points.bin", "points");
    WriteText(RecordFile(workspace_), "{}");
    WriteText(LogFile(workspace_), "said");
  }
  void Remove() const { RemoveRuns(request_, plan_, Silent()); }

  BenchRequest request_;
  BenchPlan plan_;
  fs::path workspace_;
};

TEST_F(RemoveRunsTest, TakesThePlansRunsAlone) {
  WriteText(dir / "out/runs/other/options.json", R"({"program": "oraclegs"})");
  WriteText(WorkspaceOf(request_, plan_.runs[1]) / "notes.txt", "mine, and no workspace");
  Remove();
  EXPECT_FALSE(fs::exists(workspace_));
  EXPECT_FALSE(fs::exists(RecordFile(workspace_)));
  EXPECT_FALSE(fs::exists(LogFile(workspace_)));
  EXPECT_TRUE(fs::exists(dir / "out/runs/other/options.json"));
  EXPECT_TRUE(fs::exists(WorkspaceOf(request_, plan_.runs[1]) / "notes.txt"));
}

TEST_F(RemoveRunsTest, EndsAndForgetsWhatTheQueueStillHas) {
  const FakeSlurm slurm;
  const pid_t head = fork();
  if (head == 0) {  // a call that dies while its task runs
    try {
      SlurmOptions options;
      options.poll_seconds = 0.05;
      const Job job{.name = plan_.runs[0].name,
                    .command = {"bash", "-c", "touch " + (dir / "began").string() + "; sleep 100"},
                    .log = dir / "log"};
      MakeSlurmLauncher(options, dir / "out/slurm")
          ->Run(
              {job}, [](size_t, const JobResult&) {}, Silent());
    } catch (...) {
    }
    _exit(0);
  }
  for (int i = 0; i < 12000 && !fs::exists(dir / "began"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(head, SIGKILL);
  waitpid(head, nullptr, 0);
  Remove();
  EXPECT_EQ(slurm.Get("1_0.state"), "CANCELLED\n");
  EXPECT_FALSE(fs::exists(dir / "out/slurm")) << "or the task's end is taken for that of a run of this call";
  EXPECT_FALSE(fs::exists(workspace_));
}

TEST_F(RemoveRunsTest, RemovesNothingWhereARunStillWorks) {
  const FolderLock at_work(workspace_);
  EXPECT_THAT(MessageOf<RunError>([&] { Remove(); }), AllOf(HasSubstr(workspace_), HasSubstr("still works there")));
  EXPECT_TRUE(fs::exists(workspace_ / "sfm/points.bin"));
}

TEST_F(RemoveRunsTest, SaysWhatItCannotRemove) {
  if (geteuid() == 0) GTEST_SKIP() << "nothing is closed to root";
  fs::permissions(workspace_ / "sfm", fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_THAT(MessageOf<RunError>([&] { Remove(); }), AllOf(HasSubstr(workspace_), HasSubstr("cannot be removed")));
  fs::permissions(workspace_ / "sfm", fs::perms::owner_all);
}

}  // namespace

}  // namespace oraclegs
