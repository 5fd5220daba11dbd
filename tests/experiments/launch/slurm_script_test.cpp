#include "oraclegs/experiments/launch/slurm_script.h"

#include <gtest/gtest.h>

#include "oraclegs/core/files.h"
#include "oraclegs/core/subprocess.h"
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
  // The array of 40 MB lives in a grandchild, for longer than the second between two looks.
  const std::string body = "bash -c 'x=$(head -c 40000000 /dev/zero | tr \"\\0\" a); sleep 1.5; echo ${#x}'; true";
  WriteSlurmTasks(dir / "array", {{"a", {"bash", "-c", body}, dir / "log"}});
  RunTask(dir / "array", 0);
  const auto end = ReadSlurmTaskEnd(dir / "array", 0);
  ASSERT_TRUE(end);
  EXPECT_GT(end->peak_bytes, 40'000'000);
  EXPECT_GT(end->seconds, 1.4);
  EXPECT_FALSE(end->told_to_end);
}

TEST(SlurmScript, NotesASignalAndHowTheCommandTookIt) {
  const TempDir dir;
  // Slurm sends SIGTERM to all processes of a job; the command stops cleanly with a code of its own.
  const std::string body = "trap 'exit 130' TERM; kill -TERM $PPID $$; sleep 5";
  WriteSlurmTasks(dir / "array", {{"a", {"bash", "-c", body}, dir / "log"}});
  EXPECT_EQ(RunTask(dir / "array", 0).exit_code, 130);
  const auto end = ReadSlurmTaskEnd(dir / "array", 0);
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->told_to_end);
  EXPECT_EQ(end->exit_code, 130);
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
