#include "oraclegs/experiments/launch/slurm_cancel.h"

#include <gmock/gmock.h>

#include "experiments/launch/fake_slurm.h"
#include "experiments/launch/slurm_jobs.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/experiments/launch/slurm_record.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::Contains;
using testing::HasSubstr;

class SlurmCancelTest : public SlurmJobs {
 protected:
  /// Starts jobs in a process that is killed once they run and the record has the number of their array.
  void Abandon(const std::vector<Job>& jobs) {
    const pid_t head = Fork([&] { Run(jobs); });
    for (const Job& job : jobs) WaitForStart(job.name);
    ASSERT_TRUE(WaitUntil([&] { return !ReadSlurmRecord(folder_).submissions.at(0).array.empty(); }));
    kill(head, SIGKILL);
    waitpid(head, nullptr, 0);
  }

  FakeSlurm slurm_;
};

TEST_F(SlurmCancelTest, EndsWhatAKilledProcessLeft) {
  Abandon({Shell("a", "sleep 100"), Shell("b", "sleep 100")});
  CancelOpenSlurmTasks(folder_, events_.AsListener());
  EXPECT_EQ(slurm_.Get("1_0.state"), "CANCELLED\n");
  EXPECT_EQ(slurm_.Get("1_1.state"), "CANCELLED\n");
  EXPECT_THAT(events_.notes, Contains("cancelled 2 jobs of an earlier start in Slurm"));
  CancelOpenSlurmTasks(folder_, events_.AsListener());
  EXPECT_EQ(slurm_.Get("cancelled"), "1_0 1_1\n") << "once";
}

TEST_F(SlurmCancelTest, EndsAnArrayWhoseNumberNobodyRead) {
  slurm_.Set("killer");
  const pid_t head = Fork([&] { Run({Shell("a", "sleep 100")}); });
  waitpid(head, nullptr, 0);
  CancelOpenSlurmTasks(folder_, events_.AsListener());
  EXPECT_EQ(slurm_.Get("1_0.state"), "CANCELLED\n");
}

TEST_F(SlurmCancelTest, AsksNobodyWhereNothingIsOpen) {
  CancelOpenSlurmTasks(dir_ / "none", Silent());
  Run({Shell("a", "true")});
  slurm_.Set("silent");
  CancelOpenSlurmTasks(folder_, Silent());
}

TEST_F(SlurmCancelTest, LeavesArraysThatTheRecordHasNot) {
  Abandon({Shell("a", "sleep 100")});
  const std::string name = ReadSlurmRecord(folder_).name;
  slurm_.Set("777.name", name + "\n");
  slurm_.Set("777_3.state", "RUNNING\n");
  CancelOpenSlurmTasks(folder_, Silent());
  EXPECT_EQ(slurm_.Get("1_0.state"), "CANCELLED\n");
  EXPECT_EQ(slurm_.Get("777_3.state"), "RUNNING\n");
}

TEST_F(SlurmCancelTest, SaysWhyItCannot) {
  Abandon({Shell("a", "sleep 100")});
  slurm_.Set("silent");
  EXPECT_THAT(MessageOf<RunError>([&] { CancelOpenSlurmTasks(folder_, Silent()); }), HasSubstr("squeue"));
  slurm_.Unset("silent");
  WriteText(folder_ / "slurm.json", "{");
  EXPECT_THAT(MessageOf<InputError>([&] { CancelOpenSlurmTasks(folder_, Silent()); }), HasSubstr("is damaged"));
}

}  // namespace
}  // namespace oraclegs
