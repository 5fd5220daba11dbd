#include "oraclegs/experiments/bench/bench_overwrite.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "experiments/bench/small_bench.h"
#include "experiments/launch/fake_slurm.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/experiments/bench/run_record.h"
#include "oraclegs/experiments/launch/slurm_launcher.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

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
