#include "oraclegs/core/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

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

}  // namespace
}  // namespace oraclegs
