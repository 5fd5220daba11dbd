#include "oraclegs/experiments/launch/slurm_record.h"
#include "experiments/launch/fake_slurm.h"
#include "experiments/launch/slurm_jobs.h"
#include "oraclegs/core/folder_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

TEST(SlurmRecord, ComesBackAsItWasWritten) {
  const TempDir dir;
  SlurmRecord record = ReadSlurmRecord(dir.path());
  EXPECT_NE(record.name, ReadSlurmRecord(dir.path()).name) << "a new one has a name of its own";
  record.cluster = "alps";
  record.submissions = {{"12", "0000", {{"garden/ours", "ab", 1, true, false}, {"b", "cd", 0, false, true}}},
                        {"", "0001", {}}};
  WriteSlurmRecord(dir.path(), record);
  EXPECT_EQ(ReadSlurmRecord(dir.path()), record);
}

TEST(SlurmRecord, SaysThatItIsDamaged) {
  const TempDir dir;
  for (const char* text : {"{}", "[]", "{\"name\": 3, \"cluster\": \"\", \"submissions\": []}", "{"}) {
    WriteText(dir / "slurm.json", text);
    EXPECT_THAT(MessageOf<InputError>([&] { ReadSlurmRecord(dir.path()); }), testing::HasSubstr("slurm.json")) << text;
  }
}

TEST(SlurmRecord, TrustsNoNamesButItsOwn) {
  const TempDir dir;
  SlurmRecord good = ReadSlurmRecord(dir.path());
  good.cluster = "alps-2";
  good.submissions = {{"12", "0000", {}}};
  const auto is_refused = [&](const SlurmRecord& record) {
    WriteSlurmRecord(dir.path(), record);
    const std::string message = MessageOf<InputError>([&] { ReadSlurmRecord(dir.path()); });
    return message.find("slurm.json: is damaged") != std::string::npos;
  };
  for (const std::string name :
       {"train-my-thesis", "", "oraclegs-", "oraclegs-0123456789abcde", "oraclegs-0123456789abcdeg",
        "oraclegs-0123456789abcdef,train", "oraclegs-0123456789ABCDEF"}) {
    SlurmRecord record = good;
    record.name = name;
    EXPECT_TRUE(is_refused(record)) << name;
  }
  for (const std::string array : {"12_3", "-u", "12 13", "../1"}) {
    SlurmRecord record = good;
    record.submissions[0].array = array;
    EXPECT_TRUE(is_refused(record)) << array;
  }
  for (const std::string folder : {"", "..", "0000/../..", "/home"}) {
    SlurmRecord record = good;
    record.submissions[0].folder = folder;
    EXPECT_TRUE(is_refused(record)) << folder;
  }
  SlurmRecord record = good;
  record.cluster = "a,b";
  EXPECT_TRUE(is_refused(record));
  WriteSlurmRecord(dir.path(), good);
  EXPECT_EQ(ReadSlurmRecord(dir.path()), good);
}

TEST(SlurmRecord, TheDigestKnowsWhereWordsEnd) {
  const auto digest = [](std::vector<std::string> command) {
    return SlurmCommandDigest({.name = {}, .command = std::move(command), .log = {}});
  };
  EXPECT_EQ(digest({"a", "b"}), digest({"a", "b"}));
  EXPECT_NE(digest({"a", "b"}), digest({"ab"}));
  EXPECT_NE(digest({"a", ""}), digest({"a"}));
}

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
