#include "oraclegs/core/folder_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>

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

TEST(FolderLock, HoldsNothingOfWhatIsNoFolder) {
  TempDir dir;
  EXPECT_FALSE(FolderLock(dir / "missing").held());
  EXPECT_FALSE(IsFolderLocked(dir / "missing"));
  WriteText(dir / "file", "");
  EXPECT_FALSE(FolderLock(dir / "file").held());
}

}  // namespace
}  // namespace oraclegs
