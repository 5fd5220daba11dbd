// Against a real Slurm, which tests/slurm/run.sh starts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "experiments/launch/slurm_jobs.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class RealSlurm : public SlurmJobs {
 protected:
  void SetUp() override {
    if (!std::getenv("ORACLEGS_TEST_SLURM")) GTEST_SKIP() << "needs a Slurm: tests/slurm/run.sh starts one";
    options_.poll_seconds = 0.5;
    options_.cpus = 1;
  }
  /// "array_index" of the task that runs `name`, as the job has noted it; "" before.
  std::string TaskOf(const std::string& name) const {
    std::string task;
    std::ifstream(dir_ / (name + ".task")) >> task;
    return task;
  }
  /// A job that notes its task, and then waits until the file `go` exists.
  Job Waiting(const std::string& name) const {
    return Shell(name, "printf '%s_%s\\n' $SLURM_ARRAY_JOB_ID $SLURM_ARRAY_TASK_ID >" +
                           (dir_ / (name + ".task")).string() + "; until [[ -e " + (dir_ / "go").string() +
                           " ]]; do sleep 0.1; done");
  }
  void Go() const { WriteText(dir_ / "go", "now"); }
};

TEST_F(RealSlurm, RunsTheJobsOfASuite) {
  std::vector<Job> jobs;
  for (int i = 0; i < 6; ++i) jobs.push_back(Shell("job" + std::to_string(i), "sleep 0.5"));
  jobs.push_back(Shell("input", "exit 3"));
  jobs.push_back(Shell("killed", "kill -KILL $$"));
  jobs.push_back(Shell("large", HoldMemory(30, folder_ / "0000/8.memory")));
  jobs.push_back({"odd", {"printf", "<%s>", "it's", "$HOME", "a\nb", "%j"}, dir_ / "logs" / "odd.log"});
  options_.max_running = 3;
  const auto ends = Run(jobs);
  for (int i = 0; i < 6; ++i) {
    const JobResult& end = ends.at("job" + std::to_string(i));
    EXPECT_EQ(end.end, JobEnd::kDone) << end.why;
    EXPECT_GT(end.seconds, 0.4);
    EXPECT_EQ(Starts("job" + std::to_string(i)), 1);
  }
  EXPECT_EQ(ends.at("input").exit_code, 3);
  EXPECT_EQ(ends.at("input").end, JobEnd::kFailed);
  EXPECT_EQ(ends.at("killed").end, JobEnd::kOutOfMemory);
  EXPECT_GT(ends.at("large").peak_bytes, 30'000'000);
  EXPECT_EQ(ReadFile(dir_ / "logs" / "odd.log"), "<it's><$HOME><a\nb><%j>");
}

TEST_F(RealSlurm, SubmitsAgainWhatSomebodyCancels) {
  std::jthread somebody([&] {
    WaitForStart("a");
    EXPECT_TRUE(WaitUntil([&] { return !TaskOf("a").empty(); }));
    RunProcess({"scancel", TaskOf("a")});
    Go();
  });
  const auto ends = Run({Waiting("a"), Shell("b", "true")});
  EXPECT_EQ(ends.at("a").end, JobEnd::kDone) << ends.at("a").why;
  EXPECT_EQ(ends.at("b").end, JobEnd::kDone);
  EXPECT_EQ(Starts("a"), 2);
  EXPECT_EQ(Starts("b"), 1);
  EXPECT_THAT(events_.notes, testing::Contains(HasSubstr("a was cancelled; is submitted again, 1 of 2")));
}

TEST_F(RealSlurm, ACancelledCommandGetsTheSignalOnce) {
  options_.retries = 0;
  const std::string file = (dir_ / "signals").string();
  std::jthread somebody([&] {
    WaitForStart("a");
    EXPECT_TRUE(WaitUntil([&] { return std::filesystem::exists(dir_ / "listens"); }));
    RunProcess({"squeue", "--noheader", "--array", "--format=%i"}, {}, [](const std::string& task) {
      RunProcess({"scancel", SplitTrimmed(task, ' ').front()});
    });
  });
  const auto ends =
      Run({Shell("a", "trap 'echo signal >>" + file + "; n=1' TERM; n=0; touch " + (dir_ / "listens").string() +
                          "; for i in {1..3000}; do sleep 0.1; "
                          "if ((n)) && ((++n > 20)); then exit 130; fi; done")});
  EXPECT_EQ(ends.at("a").end, JobEnd::kCancelled);
  EXPECT_EQ(ReadFile(file), "signal\n") << "a second one would end a run without a clean stop";
}

TEST_F(RealSlurm, AKilledHeadFindsItsArrayAgain) {
  const std::vector<Job> jobs = {Waiting("a"), Shell("b", "true"), Waiting("c")};
  const pid_t head = Fork([&] { Run(jobs); });
  WaitForStart("a");
  WaitForStart("c");
  kill(head, SIGKILL);
  waitpid(head, nullptr, 0);
  Go();
  const auto ends = Run({jobs[0], jobs[2]});
  EXPECT_EQ(ends.at("a").end, JobEnd::kDone);
  EXPECT_EQ(ends.at("c").end, JobEnd::kDone);
  EXPECT_EQ(Starts("a") + Starts("b") + Starts("c"), 3);
  EXPECT_THAT(events_.notes, testing::ElementsAre("found 2 jobs of an earlier start in Slurm"));
}

TEST_F(RealSlurm, AHeadKilledAtAnyMomentLosesNothingAndRunsNothingTwice) {
  std::vector<Job> jobs;
  for (int i = 0; i < 8; ++i) jobs.push_back(Waiting("job" + std::to_string(i)));
  for (int moment = 0; moment < 12; ++moment) {  // sbatch takes about 20 ms; half of the moments lie within it
    const pid_t head = Fork([&] { Run(jobs); });
    std::this_thread::sleep_for(std::chrono::milliseconds(5 + 8 * moment));
    kill(head, SIGKILL);
    waitpid(head, nullptr, 0);
  }
  Go();
  const auto ends = Run(jobs);
  for (const Job& job : jobs) {
    EXPECT_EQ(ends.at(job.name).end, JobEnd::kDone) << ends.at(job.name).why;
    EXPECT_EQ(Starts(job.name), 1) << job.name;
  }
}

TEST_F(RealSlurm, AnInterruptEmptiesTheQueue) {
  std::jthread user([&] {
    WaitForStart("a");
    RequestInterrupt(true);
  });
  const std::vector<Job> jobs = {Waiting("a"), Waiting("b"), Waiting("c"), Waiting("d"), Waiting("e"), Waiting("f")};
  const std::string message = MessageOf<Interrupted>([&] { Run(jobs); });
  EXPECT_THAT(message,
              AllOf(StartsWith("interrupted; what was left of array "), HasSubstr("the same command goes on")));
  RequestInterrupt(false);
  std::string queue;
  WaitUntil([&] { return (queue = RunProcess({"squeue", "--noheader"}).output).empty(); });
  EXPECT_EQ(queue, "");
  Go();
  options_.retries = 0;
  for (const auto& [name, end] : Run(jobs)) EXPECT_EQ(end.end, JobEnd::kDone) << name << ": " << end.why;
}

TEST_F(RealSlurm, SaysWhatSbatchSays) {
  const std::vector<Job> jobs = {Shell("a", "true")};
  options_.partition = "nowhere";
  EXPECT_EQ(MessageOf<RunError>([&] { Run(jobs); }),
            "sbatch does not take the jobs: Batch job submission failed: Invalid partition name specified");
  options_.partition = "", options_.time = "soon";
  EXPECT_EQ(MessageOf<RunError>([&] { Run(jobs); }), "sbatch does not take the jobs: Invalid --time specification");
  options_.time = "", options_.gpus = 1;
  EXPECT_EQ(MessageOf<RunError>([&] { Run(jobs); }),
            "sbatch does not take the jobs: Invalid generic resource (gres) specification");
  options_.gpus = 0;
  EXPECT_EQ(Run(jobs).at("a").end, JobEnd::kDone);
  EXPECT_EQ(Starts("a"), 1);
}

TEST_F(RealSlurm, SaysWhyAJobWaitsForEver) {
  options_.cpus = 4000;
  std::string warning;
  const Listener until_warned = [&](const Event& event) {
    if (const auto* warned = std::get_if<Warning>(&event)) {
      warning = warned->text;
      RequestInterrupt(true);
    }
  };
  EXPECT_THROW(MakeSlurmLauncher(options_, folder_)
                   ->Run(
                       {Shell("a", "true")}, [](size_t, const JobResult&) {}, until_warned),
               Interrupted);
  EXPECT_EQ(warning, "jobs wait in Slurm's queue: PartitionConfig; the cluster may not have what they ask for");
}

TEST_F(RealSlurm, ATimeLimitEndsAJob) {
  if (std::string(std::getenv("ORACLEGS_TEST_SLURM")) != "long") GTEST_SKIP() << "needs ORACLEGS_TEST_SLURM=long: 70 s";
  options_.time = "1";
  EXPECT_EQ(Run({Shell("a", "sleep 300")}).at("a").end, JobEnd::kOutOfTime);
}

}  // namespace
}  // namespace oraclegs
