#include "oraclegs/experiments/launch/slurm_launcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <thread>

#include "experiments/launch/fake_slurm.h"
#include "experiments/launch/slurm_jobs.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class SlurmLauncherTest : public SlurmJobs {
 protected:
  void Go() const { WriteText(dir_ / "go", "now"); }

  FakeSlurm slurm_;
  const std::string until_go_ = "until [[ -e " + (dir_ / "go").string() + " ]]; do sleep 0.05; done";
};

TEST_F(SlurmLauncherTest, RunsEachJobOnceInOneArray) {
  options_.partition = "gpu", options_.gpus = 1, options_.time = "4:00:00", options_.max_running = 2;
  options_.arguments = {"--account=a b"};
  const std::string odd = "it's $HOME; \"a\"\n*";
  std::vector<Job> jobs = {Shell("a", "echo said"), Shell("b", "true"), Shell("c", "true")};
  jobs.push_back({"odd", {"printf", "%s", odd}, dir_ / "logs" / "o'dd.log"});
  const auto ends = Run(jobs);
  for (const auto& [name, end] : ends) {
    EXPECT_EQ(end.end, JobEnd::kDone) << name;
    EXPECT_EQ(end.exit_code, 0);
    EXPECT_EQ(end.why, "");
    EXPECT_GE(end.peak_bytes, 2048 * 1024) << "which the accounts say";
  }
  EXPECT_EQ(slurm_.Arrays(), 1);
  EXPECT_EQ(Starts("a"), 1);
  EXPECT_EQ(ReadFile(dir_ / "logs" / "a.log"), "said\n");
  EXPECT_EQ(ReadFile(dir_ / "logs" / "o'dd.log"), odd);
  EXPECT_THAT(slurm_.Calls(),
              AllOf(HasSubstr("--array=0-3%2 "), HasSubstr("--partition=gpu "), HasSubstr("--gres=gpu:1 "),
                    HasSubstr("--time=4:00:00 "), HasSubstr("--account=a b "), HasSubstr("--no-requeue ")));
}

TEST_F(SlurmLauncherTest, ReportsTheExitCodeOfAFailedJobAndRunsTheOthers) {
  const auto ends = Run({Shell("good", "true"), Shell("input", "exit 3")});
  EXPECT_EQ(ends.at("good").end, JobEnd::kDone);
  EXPECT_EQ(ends.at("input").end, JobEnd::kFailed);
  EXPECT_EQ(ends.at("input").exit_code, 3);
  EXPECT_THAT(ends.at("input").why, AllOf(StartsWith("ended with exit code 3"), HasSubstr("input.log")));
  EXPECT_EQ(Starts("input"), 1) << "a wrong input stays wrong";
}

TEST_F(SlurmLauncherTest, TriesAFailureAgainUpToTheLimit) {
  options_.retries = 1;
  const auto ends = Run({Shell("bad", "exit 4")});
  EXPECT_EQ(ends.at("bad").end, JobEnd::kFailed);
  EXPECT_EQ(Starts("bad"), 2);
  EXPECT_THAT(events_.notes, Contains(HasSubstr("is submitted again, 1 of 1")));
}

TEST_F(SlurmLauncherTest, TellsMemoryAndTimeApartFromFailures) {
  const auto ends =
      Run({Shell("memory", "echo OUT_OF_MEMORY >$FAKE_STATE_FILE; kill -KILL $$"),
           Shell("time", "echo TIMEOUT >$FAKE_STATE_FILE; kill -TERM $$"), Shell("kernel", "kill -KILL $$")});
  EXPECT_EQ(ends.at("memory").end, JobEnd::kOutOfMemory);
  EXPECT_EQ(ends.at("time").end, JobEnd::kOutOfTime);
  EXPECT_EQ(ends.at("kernel").end, JobEnd::kOutOfMemory);
  EXPECT_EQ(ends.at("kernel").exit_code, 137);
  EXPECT_EQ(Starts("memory") + Starts("time") + Starts("kernel"), 3) << "none is tried again";
}

TEST_F(SlurmLauncherTest, SubmitsACancelledJobAgain) {
  const std::string body = "[[ -e " + (dir_ / "second").string() + " ]] && exit 0; touch " +
                           (dir_ / "second").string() + "; scancel $FAKE_TASK; sleep 300";
  const auto ends = Run({Shell("twice", body), Shell("other", "true")});
  EXPECT_EQ(ends.at("twice").end, JobEnd::kDone);
  EXPECT_EQ(Starts("twice"), 2);
  EXPECT_EQ(Starts("other"), 1);
  EXPECT_EQ(slurm_.Arrays(), 2);
}

TEST_F(SlurmLauncherTest, EndsAsCancelledWhenItHappensTooOften) {
  options_.retries = 1;
  const auto ends = Run({Shell("always", "scancel $FAKE_TASK; sleep 300")});
  EXPECT_EQ(ends.at("always").end, JobEnd::kCancelled);
  EXPECT_EQ(Starts("always"), 2);
}

TEST_F(SlurmLauncherTest, NeedsNoAccounts) {
  slurm_.Set("no_accounts");
  const auto ends = Run({Shell("good", "until [[ -e " + ShellQuoted((folder_ / "0000/0.memory").string()) +
                                           " ]]; do sleep 0.05; done; sleep 1.5"),
                         Shell("bad", "exit 2")});
  EXPECT_EQ(ends.at("good").end, JobEnd::kDone);
  EXPECT_GT(ends.at("good").seconds, 1.4);
  EXPECT_GT(ends.at("good").peak_bytes, 0) << "as the script has seen it";
  EXPECT_EQ(ends.at("bad").exit_code, 2);
}

TEST_F(SlurmLauncherTest, AKilledHeadFindsItsArrayAgain) {
  const std::vector<Job> jobs = {Shell("fast", "true"), Shell("slow", until_go_)};
  const pid_t head = Fork([&] { Run(jobs); });
  WaitForStart("slow");
  kill(head, SIGKILL);
  waitpid(head, nullptr, 0);
  Go();
  const std::vector<Job> left = {jobs[1]};  // the caller has the first one's result
  const auto ends = Run(left);
  EXPECT_EQ(ends.at("slow").end, JobEnd::kDone);
  EXPECT_EQ(Starts("slow"), 1);
  EXPECT_EQ(slurm_.Arrays(), 1);
}

TEST_F(SlurmLauncherTest, AHeadKilledWhileItSubmitsFindsTheArrayByItsName) {
  slurm_.Set("killer");
  const std::vector<Job> jobs = {Shell("a", "sleep 0.2"), Shell("b", "sleep 0.2")};
  const pid_t head = Fork([&] { Run(jobs); });
  int status = 0;
  waitpid(head, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it has not died";
  const auto ends = Run(jobs);
  EXPECT_EQ(ends.at("a").end, JobEnd::kDone);
  EXPECT_EQ(Starts("a"), 1);
  EXPECT_EQ(Starts("b"), 1);
  EXPECT_EQ(slurm_.Arrays(), 1);
}

TEST_F(SlurmLauncherTest, AJobWhoseEndWasReportedRunsAgainWhenItIsGivenAgain) {
  Run({Shell("a", "true")});
  Run({Shell("a", "true")});
  EXPECT_EQ(Starts("a"), 2);
}

TEST_F(SlurmLauncherTest, CancelsTheOldCommandOfAName) {
  const pid_t head = Fork([&] { Run({Shell("a", "sleep 300")}); });
  WaitForStart("a");
  kill(head, SIGKILL);
  waitpid(head, nullptr, 0);
  const auto ends = Run({Shell("a", "echo new")});
  EXPECT_EQ(ends.at("a").end, JobEnd::kDone);
  EXPECT_EQ(ReadFile(dir_ / "logs" / "a.log"), "new\n");
  EXPECT_EQ(slurm_.Get("cancelled"), "1_0\n");
}

TEST_F(SlurmLauncherTest, CancelsNoArrayOfAnotherName) {
  slurm_.Set("777.name", "train-my-thesis\n");
  slurm_.Set("777_0.state", "RUNNING\n");
  WriteText(
      folder_ / "slurm.json",
      R"({"program": "oraclegs", "name": "oraclegs-0123456789abcdef", "cluster": "", "submissions": [{"array": "777",
                "folder": "0000", "tasks": [{"job": "a", "command": "other", "attempt": 0, "open": true, "cancelled": false}]}]})");
  const auto ends = Run({Shell("a", "echo new")});
  EXPECT_EQ(ends.at("a").end, JobEnd::kDone);
  EXPECT_EQ(slurm_.Get("777_0.state"), "RUNNING\n");
  EXPECT_EQ(slurm_.Get("cancelled"), "");
}

TEST_F(SlurmLauncherTest, AnInterruptCancelsWhatRunsAndTheNextStartGoesOn) {
  const std::string go = (dir_ / "go").string();
  const std::vector<Job> jobs = {Shell("a", "[[ -e " + go + " ]] || sleep 300"),
                                 Shell("b", "[[ -e " + go + " ]] || sleep 300")};
  std::jthread user([&] {
    WaitForStart("a");
    WaitForStart("b");
    RequestInterrupt(true);
  });
  const std::string message = MessageOf<Interrupted>([&] {
    MakeSlurmLauncher(options_, folder_)
        ->Run(
            jobs, [](size_t, const JobResult&) { FAIL(); }, Silent());
  });
  user.join();
  EXPECT_EQ(message,
            "interrupted; what was left of array 1 in Slurm was cancelled; the same command goes on with the jobs that "
            "are not done");
  EXPECT_EQ(slurm_.Get("1_0.state"), "CANCELLED\n");
  EXPECT_EQ(slurm_.Get("1_1.state"), "CANCELLED\n");
  RequestInterrupt(false);
  std::ofstream(go) << "now";
  options_.retries = 0;  // what the user stopped is no failed try
  EXPECT_EQ(Run(jobs).at("b").end, JobEnd::kDone);
  EXPECT_EQ(slurm_.Arrays(), 2);
}

TEST_F(SlurmLauncherTest, AnExceptionOfTheCallerEndsWhatRuns) {
  const std::vector<Job> jobs = {Shell("a", "true"), Shell("b", "sleep 300")};
  const std::string message = MessageOf<RunError>([&] {
    MakeSlurmLauncher(options_, folder_)
        ->Run(
            jobs, [](size_t, const JobResult&) { throw RunError("the disk is full"); }, Silent());
  });
  EXPECT_EQ(message, "the disk is full");
  EXPECT_EQ(slurm_.Get("1_1.state"), "CANCELLED\n");
}

TEST_F(SlurmLauncherTest, SaysInOneLineWhatSbatchSays) {
  slurm_.Set("refuse", "Batch job submission failed: Invalid partition name specified");
  options_.partition = "nowhere";
  EXPECT_EQ(MessageOf<RunError>([&] { Run({Shell("a", "true")}); }),
            "sbatch does not take the jobs: Batch job submission failed: Invalid partition name specified");
  slurm_.Unset("refuse");
  EXPECT_EQ(Run({Shell("a", "true")}).at("a").end, JobEnd::kDone);
  EXPECT_EQ(Starts("a"), 1);
}

TEST_F(SlurmLauncherTest, WaitsForAControllerThatIsAway) {
  std::jthread admin([&] {
    WaitForStart("a");
    slurm_.Set("silent");
    EXPECT_TRUE(WaitUntil([&] { return slurm_.Get("asked").size() >= 2; }));
    slurm_.Unset("silent");
    Go();
  });
  const auto ends = Run({Shell("a", until_go_)});
  admin.join();
  EXPECT_EQ(ends.at("a").end, JobEnd::kDone);
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("squeue does not answer: Unable to contact slurm controller")));
}

TEST_F(SlurmLauncherTest, GivesUpWhenSbatchRefusesForLongAndTheQueueAnswers) {
  // sbatch takes no more once the first array runs.
  const std::vector<Job> jobs = {Shell("bad", "echo 'the quota is used up' >$FAKE_SLURM/refuse; exit 4"),
                                 Shell("other", until_go_)};
  const std::string message = MessageOf<RunError>([&] {
    MakeSlurmLauncher(options_, folder_, std::chrono::milliseconds(500))
        ->Run(
            jobs, [](size_t, const JobResult&) { FAIL(); }, events_.AsListener());
  });
  EXPECT_EQ(
      message,
      "sbatch does not take the jobs: the quota is used up; what was submitted goes on, the same command finds it "
      "again");
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("the quota is used up; what was submitted goes on")));
  Go();
  EXPECT_EQ(Run({jobs[1]}).at("other").end, JobEnd::kDone);
  EXPECT_EQ(Starts("other"), 1);
}

TEST_F(SlurmLauncherTest, NamesWhatTheBatchScriptSaysWhereThereIsNoLog) {
  options_.retries = 0;
  std::vector<Job> jobs = {Shell("a", "true")};
  jobs[0].log = dir_.path();
  EXPECT_THAT(Run(jobs).at("a").why, HasSubstr("0000/slurm-0.out has its output"));
}

TEST_F(SlurmLauncherTest, SaysHowToGoOnWithoutSlurm) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", dir_.path().c_str(), 1);
  const std::string message = MessageOf<RunError>([&] { Run({Shell("a", "true")}); });
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, AllOf(StartsWith("sbatch is not in PATH: install Slurm"), HasSubstr("--launcher local")));
}

TEST_F(SlurmLauncherTest, RefusesAFolderThatAnotherProcessFollows) {
  const pid_t head = Fork([&] { Run({Shell("a", "sleep 300")}); });
  WaitForStart("a");
  EXPECT_THAT(MessageOf<RunError>([&] { Run({Shell("a", "sleep 300")}); }),
              HasSubstr("process " + std::to_string(head) + " on "));
  kill(head, SIGKILL);
  waitpid(head, nullptr, 0);
}

TEST_F(SlurmLauncherTest, RunsNoMoreThanTheLimitWhenJobsAreTriedAgain) {
  options_.max_running = 1, options_.retries = 1;
  Run({Shell("a", "exit 4"), Shell("b", "true"), Shell("c", "true")});
  EXPECT_EQ(Starts("a"), 2);
  EXPECT_THAT(slurm_.Calls(), AllOf(HasSubstr("--array=0-2%1 "), HasSubstr("--array=0-0%1 ")));
}

TEST_F(SlurmLauncherTest, NoJobsAreNoArray) {
  EXPECT_THAT(Run({}), IsEmpty());
  EXPECT_EQ(slurm_.Arrays(), 0);
}

}  // namespace
}  // namespace oraclegs
