#include "oraclegs/core/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/host.h"
#include "support/errors.h"
#include "support/temp_dir.h"
#include "support/wait_until.h"

namespace oraclegs {
namespace {

size_t FilesIn(const std::filesystem::path& folder) {
  return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

TEST(AtomicFile, AppearsWhenItIsFinished) {
  const TempDir dir;
  WriteFileAtomically(dir / "a", "old");
  {
    AtomicFile file(dir / "a");
    file.Append("new ");
    file.Append("content");
    EXPECT_EQ(ReadFile(dir / "a"), "old");
    file.Finish();
    EXPECT_EQ(ReadFile(dir / "a"), "new content");
  }
  EXPECT_EQ(FilesIn(dir.path()), 1u);
}

TEST(AtomicFile, LeavesNothingUnlessItIsFinished) {
  const TempDir dir;
  {
    AtomicFile file(dir / "a");
    file.Append("half");
    file.Flush();
    EXPECT_EQ(FilesIn(dir.path()), 1u);
  }
  EXPECT_EQ(FilesIn(dir.path()), 0u);
}

TEST(AtomicFile, NamesTheWantedFileInErrors) {
  const TempDir dir;
  EXPECT_EQ(MessageOf<RunError>([&] { AtomicFile file(dir / "none/a"); }),
            (dir / "none/a").string() + ": cannot write: No such file or directory");
  std::filesystem::create_directory(dir / "folder");
  AtomicFile file(dir / "folder");
  EXPECT_THAT(MessageOf<RunError>([&] { file.Finish(); }),
              testing::StartsWith((dir / "folder").string() + ": cannot write: "));
}

TEST(RemoveLeftovers, LeavesOnlyWhatARunningProcessMakes) {
  const TempDir dir;
  const pid_t ended = fork();
  if (ended == 0) _exit(0);
  waitpid(ended, nullptr, 0);
  const auto name = [](pid_t pid) { return ".oraclegs-" + std::to_string(pid) + "-3.tmp"; };
  const std::filesystem::path running = dir / name(getppid());
  WriteFileAtomically(dir / name(ended), "of one that was killed");
  WriteFileAtomically(dir / "deep" / name(getpid()), "of one with our number");
  WriteFileAtomically(dir / ".oraclegs-photos.tmp" / "1.jpg", "a folder");
  WriteFileAtomically(dir / "kept.tmp", "somebody's");
  WriteFileAtomically(dir / ".oraclegs-notes", "somebody's");
  WriteFileAtomically(running, "made now");
  const TempDir elsewhere;
  WriteFileAtomically(elsewhere / name(ended), "not below");
  std::filesystem::create_directory_symlink(elsewhere.path(), dir / "link");
  RemoveLeftovers(dir.path());
  EXPECT_EQ(FilesIn(dir.path()), 5u);
  EXPECT_EQ(FilesIn(dir / "deep"), 0u);
  EXPECT_TRUE(std::filesystem::exists(running));
  EXPECT_TRUE(std::filesystem::exists(dir / "kept.tmp"));
  EXPECT_TRUE(std::filesystem::exists(dir / ".oraclegs-notes"));
  EXPECT_EQ(FilesIn(elsewhere.path()), 1u);
  RemoveLeftovers(dir / "none");
}

TEST(RemoveLeftovers, KnowsTheProcessOfANameThatItMade) {
  EXPECT_TRUE(IsTemporaryName(TemporaryName()));
  EXPECT_NE(TemporaryName(), TemporaryName());
  const TempDir dir;
  const pid_t child = fork();
  if (child == 0) {
    WriteText(dir / TemporaryName(), "made by the child");
    std::filesystem::create_directory(dir / TemporaryName());
    pause();
  }
  WaitUntil([&] { return FilesIn(dir.path()) == 2; });
  RemoveLeftovers(dir.path());
  EXPECT_EQ(FilesIn(dir.path()), 2u);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  RemoveLeftovers(dir.path());
  EXPECT_EQ(FilesIn(dir.path()), 0u);
}

TEST(RemoveLeftovers, WhatAnotherMachineMakesStaysForADay) {
  const TempDir dir;
  const auto yesterday = std::filesystem::file_time_type::clock::now() - std::chrono::hours(25);
  const std::string host = "no-such-" + HostName(), pid = ".oraclegs-999999999@" + host;
  WriteText(dir / (pid + "-0.tmp"), "new");
  WriteText(dir / (pid + "-1.tmp"), "old");
  std::filesystem::last_write_time(dir / (pid + "-1.tmp"), yesterday);
  for (const char* folder : {"-2.tmp", "-3.tmp"}) {
    WriteFileAtomically(dir / (pid + folder) / "deep" / "file", "x");
    if (std::string(folder) == "-3.tmp") {
      std::filesystem::last_write_time(dir / (pid + folder) / "deep" / "file", yesterday);
    }
    std::filesystem::last_write_time(dir / (pid + folder) / "deep", yesterday);
    std::filesystem::last_write_time(dir / (pid + folder), yesterday);
  }
  RemoveLeftovers(dir.path());
  EXPECT_TRUE(std::filesystem::exists(dir / (pid + "-0.tmp")));
  EXPECT_FALSE(std::filesystem::exists(dir / (pid + "-1.tmp")));
  EXPECT_TRUE(std::filesystem::exists(dir / (pid + "-2.tmp"))) << "one of its files is new";
  EXPECT_FALSE(std::filesystem::exists(dir / (pid + "-3.tmp")));
}

}  // namespace
}  // namespace oraclegs
