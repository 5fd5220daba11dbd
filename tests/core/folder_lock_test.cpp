#include "oraclegs/core/folder_lock.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/host.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

class FileLockTest : public testing::Test {
 protected:
  FileLockTest() { WriteText(path_, ""); }

  int Open(int flags = O_RDWR) const { return open(path_.c_str(), flags | O_CLOEXEC); }

  TempDir dir_;
  fs::path path_ = dir_ / "file";
};

TEST_F(FileLockTest, OneOpenFileHasIt) {
  const int one = Open(), other = Open(), reader = Open(O_RDONLY);
  EXPECT_FALSE(IsFileLocked(reader));
  EXPECT_EQ(TryLockFile(one), FileLock::kLocked);
  EXPECT_EQ(TryLockFile(one), FileLock::kLocked) << "it is its own";
  EXPECT_EQ(TryLockFile(other), FileLock::kLockedByAnother);
  EXPECT_TRUE(IsFileLocked(reader));
  EXPECT_TRUE(IsFileLocked(other));
  EXPECT_FALSE(IsFileLocked(one));
  close(reader), close(other);
  const int again = Open();
  EXPECT_TRUE(IsFileLocked(again)) << "closing others lets nothing go";
  close(one);
  EXPECT_FALSE(IsFileLocked(again));
  close(again);
}

TEST_F(FileLockTest, AForkedChildKeepsIt) {
  const int held = Open(), reader = Open(O_RDONLY);
  ASSERT_EQ(TryLockFile(held), FileLock::kLocked);
  int alive[2];
  ASSERT_EQ(pipe(alive), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(alive[1]);
    char byte = 0;
    _exit(read(alive[0], &byte, 1) == 0 ? 0 : 1);
  }
  close(held);
  EXPECT_TRUE(IsFileLocked(reader));
  close(alive[0]), close(alive[1]);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(IsFileLocked(reader));
  close(reader);
}

TEST_F(FileLockTest, NeedsAFileThatMayBeWritten) {
  const int reader = Open(O_RDONLY);
  EXPECT_EQ(TryLockFile(reader), FileLock::kUnknown);
  close(reader);
}

TEST_F(FileLockTest, KnowsWhetherTheFileHasItsName) {
  const int fd = Open();
  EXPECT_TRUE(IsStillNamed(path_, fd));
  fs::rename(path_, dir_ / "final");
  EXPECT_FALSE(IsStillNamed(path_, fd));
  WriteText(path_, "");
  EXPECT_FALSE(IsStillNamed(path_, fd)) << "it is another one";
  fs::remove(path_);
  fs::create_symlink("final", path_);
  EXPECT_FALSE(IsStillNamed(path_, fd)) << "a link is no file of that name";
  close(fd);
}

TEST(FolderLock, IsSeenAsLongAsItIsHeld) {
  TempDir dir;
  EXPECT_FALSE(IsFolderLocked(dir.path()));
  std::optional<FolderLock> lock(dir.path());
  EXPECT_TRUE(lock->held());
  EXPECT_TRUE(IsFolderLocked(dir.path()));
  EXPECT_TRUE(IsFolderLocked(dir.path())) << "looking changes nothing";
  lock.reset();
  EXPECT_FALSE(IsFolderLocked(dir.path()));
}

TEST(FolderLock, OnlyOneHoldsIt) {
  TempDir dir;
  const FolderLock first(dir.path()), second(dir.path());
  EXPECT_TRUE(first.held());
  EXPECT_FALSE(second.held());
}

TEST(FolderLock, TellsWhyItIsNotHeld) {
  TempDir dir;
  const FolderLock first(dir.path()), second(dir.path(), std::chrono::milliseconds(0));
  EXPECT_EQ(first.state(), FolderLock::State::kHeld);
  EXPECT_EQ(second.state(), FolderLock::State::kHeldByAnother);
  EXPECT_EQ(FolderLock(dir / "missing").state(), FolderLock::State::kUnknown);
}

TEST(FolderLock, SaysWhoHoldsIt) {
  TempDir dir;
  const FolderLock first(dir.path()), second(dir.path(), std::chrono::milliseconds(0));
  EXPECT_EQ(second.holder(), "process " + std::to_string(getpid()) + " on " + HostName());
  WriteText(dir / kFolderLockName, "x\x1B[31m");
  EXPECT_EQ(FolderLock(dir.path(), std::chrono::milliseconds(0)).holder(), "another process");
}

TEST(FolderLock, IsAFileThatOthersMachinesCanLock) {
  TempDir dir;
  {
    const FolderLock lock(dir.path());
    const int fd = open((dir / kFolderLockName).c_str(), O_RDONLY);
    EXPECT_TRUE(IsFileLocked(fd));
    close(fd);
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir.path())) << "it is removed with the lock";
}

TEST(FolderLock, OneThatWasLeftBehindIsTaken) {
  TempDir dir;
  WriteText(dir / kFolderLockName, "4711 node7\n");
  EXPECT_FALSE(IsFolderLocked(dir.path()));
  EXPECT_TRUE(FolderLock(dir.path()).held());
}

TEST(FolderLock, IsNotWrittenThroughALink) {
  TempDir dir;
  WriteText(dir / "mine", "text");
  std::filesystem::create_symlink("mine", dir / kFolderLockName);
  EXPECT_FALSE(FolderLock(dir.path()).held());
  EXPECT_EQ(ReadFile(dir / "mine"), "text");
}

TEST(FolderLock, OneOfManyHoldsItAtATime) {
  TempDir dir;
  std::atomic<int> holders = 0, most = 0, turns = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        const FolderLock lock(dir.path(), std::chrono::seconds(20));
        if (!lock.held()) continue;
        most = std::max<int>(most, ++holders);
        ++turns;
        --holders;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(most, 1);
  EXPECT_EQ(turns, 200);
}

TEST(FolderLock, CanBeMoved) {
  TempDir dir;
  std::optional<FolderLock> first(dir.path());
  EXPECT_EQ(HeldFolderLocks().size(), 1u);
  std::optional<FolderLock> second(std::move(*first));
  first.reset();
  EXPECT_TRUE(IsFolderLocked(dir.path()));
  EXPECT_EQ(HeldFolderLocks().size(), 1u);
  second.reset();
  EXPECT_FALSE(IsFolderLocked(dir.path()));
  EXPECT_TRUE(HeldFolderLocks().empty());
}

TEST(FolderLock, NoticesThatTheFolderIsGone) {
  TempDir dir;
  std::filesystem::create_directory(dir / "run");
  const FolderLock lock(dir / "run");
  EXPECT_TRUE(lock.IsStillThere());
  std::filesystem::remove_all(dir / "run");
  EXPECT_FALSE(lock.IsStillThere());
  std::filesystem::create_directory(dir / "run");
  EXPECT_FALSE(lock.IsStillThere()) << "it is another folder";
}

TEST(FolderLock, NoticesThatItWasRemovedItself) {
  TempDir dir;
  const FolderLock lock(dir.path());
  std::filesystem::remove(dir / kFolderLockName);
  EXPECT_FALSE(lock.IsStillThere()) << "another process could lock the folder now";
}

TEST(FolderLock, EndsWithTheProcess) {
  TempDir dir;
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const FolderLock lock(dir.path());
    const char byte = lock.held() ? 'y' : 'n';
    if (write(ready[1], &byte, 1) != 1) _exit(1);
    pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_EQ(byte, 'y');
  EXPECT_TRUE(IsFolderLocked(dir.path()));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(IsFolderLocked(dir.path()));
  close(ready[0]), close(ready[1]);
}

TEST(FolderLock, AFileOfAFolderThatWasReplacedSaysSo) {
  const TempDir dir;
  const std::filesystem::path held = dir / "held";
  std::filesystem::create_directory(held);
  const FolderLock lock(held);
  std::filesystem::rename(held, dir / "moved");
  std::filesystem::create_directory(held);
  EXPECT_THAT(MessageOf<RunError>([&] { AtomicFile file(held / "deep" / "file"); }),
              testing::StartsWith(held.string() + ": was removed or replaced"));
}

TEST(FolderLock, NothingIsMadeAnewInAFolderThatIsGone) {
  const TempDir dir;
  const std::filesystem::path held = dir / "held", other = dir / "held_not";
  std::filesystem::create_directory(held);
  const FolderLock lock(held);
  WriteFileAtomically(held / "deep" / "file", "x");
  std::filesystem::remove_all(held);
  EXPECT_THAT(MessageOf<RunError>([&] { WriteFileAtomically(held / "deep" / "file", "x"); }),
              testing::StartsWith(held.string() + ": was removed or replaced"));
  EXPECT_FALSE(std::filesystem::exists(held));
  WriteFileAtomically(other / "file", "x");
  std::filesystem::create_directory(held);
  EXPECT_THROW(WriteFileAtomically(held / "deep" / "file", "x"), RunError) << "it is another folder";
}

TEST(FolderLock, HoldsNothingOfWhatIsNoFolder) {
  TempDir dir;
  EXPECT_FALSE(FolderLock(dir / "missing").held());
  EXPECT_FALSE(IsFolderLocked(dir / "missing"));
  WriteText(dir / "file", "");
  EXPECT_FALSE(FolderLock(dir / "file").held());
}

}  // namespace

}  // namespace oraclegs
