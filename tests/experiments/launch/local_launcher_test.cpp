#include "oraclegs/experiments/launch/local_launcher.h"

#include <gmock/gmock.h>

#include <csignal>
#include <map>

#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/process_group.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class LocalLauncherTest : public testing::Test {
 protected:
  Job Shell(const std::string& name, const std::string& script) const {
    return {name, {"/bin/sh", "-c", script}, dir / "logs" / (name + ".log")};
  }
  std::vector<JobResult> Run(const std::vector<Job>& jobs, LocalWorkers workers = {}) const {
    std::vector<JobResult> results(jobs.size());
    LocalLauncher(std::move(workers))
        .Run(
            jobs, [&](size_t job, const JobResult& result) { results[job] = result; }, Silent());
    return results;
  }
  TempDir dir;
};

TEST_F(LocalLauncherTest, TellsHowJobsEnd) {
  const auto results =
      Run({Shell("good", "echo hello"), Shell("bad", "echo first; echo 'oraclegs: error: why' >&2; exit 3"),
           Shell("killed", "kill -9 $$"), Shell("ended", "kill -TERM $$"), Shell("mute", "exit 4"),
           Shell("large", "echo out of memory\\; lower --downscale; exit 4"),
           Job{"none", {"/nonexistent/program"}, dir / "none.log"}});
  EXPECT_EQ(results[0].end, JobEnd::kDone);
  EXPECT_EQ(results[0].why, "");
  EXPECT_GT(results[0].peak_bytes, 100'000);
  EXPECT_GT(results[0].seconds, 0);
  EXPECT_EQ(ReadFile(dir / "logs/good.log"), "hello\n");
  EXPECT_EQ(results[1].end, JobEnd::kFailed);
  EXPECT_EQ(results[1].exit_code, 3);
  EXPECT_EQ(results[1].why, "oraclegs: error: why");
  EXPECT_TRUE(results[2].end == JobEnd::kFailed || results[2].end == JobEnd::kOutOfMemory);
  EXPECT_EQ(results[2].exit_code, 137);
  EXPECT_EQ(results[3].end, JobEnd::kCancelled);
  EXPECT_EQ(results[4].why, "exit code 4, without a word");
  EXPECT_EQ(results[5].end, JobEnd::kOutOfMemory);
  EXPECT_EQ(results[6].end, JobEnd::kFailed);
  EXPECT_THAT(results[6].why, HasSubstr("cannot start /nonexistent/program"));
}

TEST_F(LocalLauncherTest, AppendsToTheLogAndNamesTheNewLine) {
  WriteText(dir / "logs/again.log", "old error\n");
  EXPECT_EQ(Run({Shell("again", "exit 2")})[0].why, "exit code 2, without a word");
  EXPECT_EQ(ReadFile(dir / "logs/again.log"), "old error\n");
}

TEST_F(LocalLauncherTest, AnUnwritableLogIsAResult) {
  WriteText(dir / "logs", "a file");
  const JobResult result = Run({Shell("x", "true")})[0];
  EXPECT_EQ(result.end, JobEnd::kFailed);
  EXPECT_THAT(result.why, HasSubstr("x.log: cannot write"));
}

TEST_F(LocalLauncherTest, RunsAsManyAtOnceAsThereAreWorkers) {
  // Each waits for the other: alone, it would give up.
  const std::string a = (dir / "a").string(), b = (dir / "b").string();
  const auto meet = [](const std::string& mine, const std::string& other) {
    return "touch " + mine + "; for i in $(seq 3000); do [ -e " + other + " ] && exit 0; sleep 0.02; done; exit 1";
  };
  const auto results = Run({Shell("a", meet(a, b)), Shell("b", meet(b, a))}, {2, {}});
  EXPECT_EQ(results[0].end, JobEnd::kDone);
  EXPECT_EQ(results[1].end, JobEnd::kDone);
}

TEST_F(LocalLauncherTest, WorkersTakeGpusInTurn) {
  const auto show = [](const std::string& name) { return "echo gpu $CUDA_VISIBLE_DEVICES; sleep 0.3; : " + name; };
  Run({Shell("a", show("a")), Shell("b", show("b"))}, {2, {"4", "7"}});
  EXPECT_EQ(ReadFile(dir / "logs/a.log"), "gpu 4\n");
  EXPECT_EQ(ReadFile(dir / "logs/b.log"), "gpu 7\n");
}

TEST_F(LocalLauncherTest, AnInterruptEndsWhatRuns) {
  const std::string pid_file = (dir / "pid").string();
  const std::vector<Job> jobs = {
      Shell("first", "exit 0"),
      Shell("long", "echo $$ > " + pid_file + ".part; mv " + pid_file + ".part " + pid_file + "; exec sleep 600")};
  const auto run = [&] {
    LocalLauncher(LocalWorkers{2, {}})
        .Run(
            jobs,
            [&](size_t, const JobResult&) {
              while (!std::filesystem::exists(pid_file)) continue;
              RequestInterrupt(true);
            },
            Silent());
  };
  EXPECT_THROW(run(), Interrupted);
  RequestInterrupt(false);
  const pid_t pid = std::stoi("0" + ReadFile(pid_file));
  ASSERT_GT(pid, 0);
  EXPECT_NE(kill(pid, 0), 0) << "it still runs";
}

TEST_F(LocalLauncherTest, PassesOnWhatItsCallerThrows) {
  EXPECT_EQ(MessageOf<RunError>([&] {
              LocalLauncher({}).Run(
                  {Shell("a", "true")}, [](size_t, const JobResult&) { throw RunError("full"); }, Silent());
            }),
            "full");
}

TEST(EndOfChild, ReadsTheShellsConvention) {
  EXPECT_EQ(EndOfChild(0, true, ""), JobEnd::kDone);
  EXPECT_EQ(EndOfChild(kKilledBySignal + SIGKILL, true, ""), JobEnd::kOutOfMemory);
  EXPECT_EQ(EndOfChild(kKilledBySignal + SIGKILL, false, ""), JobEnd::kFailed);
  EXPECT_EQ(EndOfChild(kKilledBySignal + SIGINT, false, ""), JobEnd::kCancelled);
  EXPECT_EQ(EndOfChild(kKilledBySignal + SIGSEGV, true, ""), JobEnd::kFailed);
  EXPECT_EQ(EndOfChild(4, false, "oraclegs: error: out of memory; lower"), JobEnd::kOutOfMemory);
  EXPECT_EQ(EndOfChild(3, true, "bad input"), JobEnd::kFailed);
}

}  // namespace
}  // namespace oraclegs
