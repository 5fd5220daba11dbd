#include "oraclegs/core/file_lock.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

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

}  // namespace
}  // namespace oraclegs
