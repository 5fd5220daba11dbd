#include "oraclegs/core/folder_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

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
  std::filesystem::remove(dir / "run");
  EXPECT_FALSE(lock.IsStillThere());
  std::filesystem::create_directory(dir / "run");
  EXPECT_FALSE(lock.IsStillThere()) << "it is another folder";
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
