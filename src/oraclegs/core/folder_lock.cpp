#include "oraclegs/core/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

namespace oraclegs {
namespace {

constexpr int kTries = 50;  // a look takes microseconds
constexpr std::chrono::milliseconds kPause(2);

int OpenFolder(const std::filesystem::path& folder) {
  return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) {
  const int fd = OpenFolder(folder);
  if (fd < 0) return;
  for (int i = 0; i < kTries; ++i) {
    if (flock(fd, LOCK_EX | LOCK_NB) == 0) {
      fd_ = fd;
      return;
    }
    if (errno != EWOULDBLOCK && errno != EINTR) break;
    std::this_thread::sleep_for(kPause);
  }
  close(fd);
}

FolderLock::~FolderLock() {
  if (fd_ >= 0) close(fd_);
}

bool IsFolderLocked(const std::filesystem::path& folder) {
  const int fd = OpenFolder(folder);
  if (fd < 0) return false;
  const bool locked = flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(fd);
  return locked;
}

}  // namespace oraclegs
