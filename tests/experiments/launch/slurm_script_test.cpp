#include "oraclegs/experiments/launch/slurm_script.h"

#include <gtest/gtest.h>

#include "experiments/launch/slurm_jobs.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/subprocess.h"
#include "oraclegs/core/text.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

ProcessResult RunTask(const fs::path& folder, int task) {
  return RunProcess({.argv = {"bash", (folder / "batch.sh").string()},
                     .variables = {{"SLURM_ARRAY_TASK_ID", std::to_string(task)}, {"SLURM_ARRAY_JOB_ID", "55"}}});
}

TEST(SlurmScript, RunsTheCommandOfItsTask) {
  const TempDir dir;
  const fs::path folder = dir / "an array's $folder";
  WriteSlurmTasks(folder, {{"a", {"false"}, dir / "a.log"},
                           {"b", {"printf", "<%s>", "", "-n", "a  b", "*", "\\", "'\"$(exit 9)`\n"}, dir / "b.log"}});
  EXPECT_EQ(ArrayOfStartedTasks(folder), "");
  EXPECT_EQ(RunTask(folder, 1).exit_code, 0);
  EXPECT_EQ(ReadFile(dir / "b.log"), "<><-n><a  b><*><\\><'\"$(exit 9)`\n>");
  EXPECT_EQ(ArrayOfStartedTasks(folder), "55");
  EXPECT_EQ(RunTask(folder, 0).exit_code, 1);
  EXPECT_EQ(ReadSlurmTaskEnd(folder, 0)->exit_code, 1);
  EXPECT_FALSE(ReadSlurmTaskEnd(folder, 2));
}

TEST(SlurmScript, AppendsToTheLog) {
  const TempDir dir;
  WriteText(dir / "log", "before\n");
  WriteSlurmTasks(dir / "array", {{"a", {"bash", "-c", "echo out; echo error >&2"}, dir / "log"}});
  EXPECT_EQ(RunTask(dir / "array", 0).exit_code, 0);
  EXPECT_EQ(ReadFile(dir / "log"), "before\nout\nerror\n");
}

TEST(SlurmScript, MeasuresTheLargestOfTheProcesses) {
  const TempDir dir;
  // The array of 40 MB lives in a grandchild.
  const std::string body = "sleep 1.5; bash -c " + ShellQuoted(HoldMemory(40, dir / "array/0.memory")) + "; true";
  WriteSlurmTasks(dir / "array", {{"a", {"bash", "-c", body}, dir / "log"}});
  RunTask(dir / "array", 0);
  const auto end = ReadSlurmTaskEnd(dir / "array", 0);
  ASSERT_TRUE(end);
  EXPECT_GT(end->peak_bytes, 40'000'000);
  EXPECT_GT(end->seconds, 1.4);
  EXPECT_FALSE(end->asked_to_end);
}

TEST(SlurmScript, NotesASignalAndHowTheCommandTookIt) {
  const TempDir dir;
  // Slurm sends SIGTERM to all processes of a job; the command stops cleanly with a code of its own.
  const std::string body = "trap 'sleep 1; exit 130' TERM; kill -TERM $PPID $$; sleep 60";
  WriteSlurmTasks(dir / "array", {{"a", {"bash", "-c", body}, dir / "log"}});
  EXPECT_EQ(RunTask(dir / "array", 0).exit_code, 130);
  const auto end = ReadSlurmTaskEnd(dir / "array", 0);
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->asked_to_end);
  EXPECT_EQ(end->exit_code, 130);
}

TEST(SlurmScript, EndsWhenTheCommandEndsWithTheSignal) {
  const TempDir dir;
  const std::string body = "trap 'exit 130' TERM; kill -TERM $PPID $$; sleep 60";
  WriteSlurmTasks(dir / "array", {{"a", {"bash", "-c", body}, dir / "log"}});
  for (int i = 0; i < 20; ++i) {
    fs::remove(dir / "array/0.end");
    RunTask(dir / "array", 0);
    const auto end = ReadSlurmTaskEnd(dir / "array", 0);
    ASSERT_TRUE(end);
    EXPECT_TRUE(end->asked_to_end);
    EXPECT_TRUE(end->exit_code == 130 || end->exit_code == 143) << end->exit_code << ": bash may have lost the code";
  }
}

TEST(SlurmScript, SaysWhereItIsWhenItCannotStart) {
  const TempDir dir;
  WriteSlurmTasks(dir / "array", {{"a", {"true"}, dir / "log"}, {"b", {"true"}, dir.path()}});
  const std::string task = ReadFile(dir / "array/0.sh");
  const std::string here = "directory=" + ShellQuoted(fs::current_path().string());
  ASSERT_NE(task.find(here), std::string::npos);
  WriteText(dir / "array/0.sh", std::string(task).replace(task.find(here), here.size(), "directory=/nowhere"));
  EXPECT_EQ(RunTask(dir / "array", 0).exit_code, 1);
  ASSERT_TRUE(ReadSlurmTaskEnd(dir / "array", 0));
  EXPECT_EQ(ReadSlurmTaskEnd(dir / "array", 0)->exit_code, 1);
  EXPECT_NE(ReadFile(dir / "log").find("/nowhere"), std::string::npos);
  EXPECT_EQ(RunTask(dir / "array", 1).exit_code, 1) << "its log is a folder";
  EXPECT_EQ(ReadSlurmTaskEnd(dir / "array", 1)->exit_code, 1);
  EXPECT_EQ(SlurmOutput("/a", 7), "/a/slurm-7.out");
}

TEST(SlurmScript, ADamagedEndIsNone) {
  const TempDir dir;
  for (const char* text : {"", "x", "1 2", "0 1 2"}) {
    WriteText(dir / "0.end", text);
    EXPECT_FALSE(ReadSlurmTaskEnd(dir.path(), 0)) << text;
  }
}

TEST(SlurmScript, ThePatternOfTheOutputKeepsPercentSigns) {
  EXPECT_EQ(SlurmOutputPattern("/a/50%/b"), "/a/50%%/b/slurm-%a.out");
}

}  // namespace
}  // namespace oraclegs
