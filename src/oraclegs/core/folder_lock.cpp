#include "oraclegs/core/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <thread>
#include <utility>

namespace oraclegs {
namespace {

constexpr std::chrono::milliseconds kPause(2);

int OpenFolder(const std::filesystem::path& folder) { return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); }

/// Descriptors of held locks.
class Held {
 public:
  static Held& Instance() {
    static Held held;
    return held;
  }
  void Add(int fd) {
    const std::lock_guard lock(mutex_);
    fds_.push_back(fd);
  }
  void Remove(int fd) {
    const std::lock_guard lock(mutex_);
    std::erase(fds_, fd);
  }
  std::vector<int> All() {
    const std::lock_guard lock(mutex_);
    return fds_;
  }

 private:
  std::mutex mutex_;
  std::vector<int> fds_;
};

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder, std::chrono::milliseconds patience) : folder_(folder) {
  fd_ = OpenFolder(folder);
  if (fd_ < 0) return;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    if (errno != EWOULDBLOCK) return;
    if (std::chrono::steady_clock::now() >= deadline) {
      state_ = State::kHeldByAnother;
      close(std::exchange(fd_, -1));
      return;
    }
    std::this_thread::sleep_for(kPause);
  }
  state_ = State::kHeld;
  Held::Instance().Add(fd_);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : folder_(std::move(other.folder_)),
      fd_(std::exchange(other.fd_, -1)),
      state_(std::exchange(other.state_, State::kUnknown)) {}

FolderLock::~FolderLock() {
  if (held()) Held::Instance().Remove(fd_);
  if (fd_ >= 0) close(fd_);
}

bool FolderLock::IsStillThere() const {
  struct stat own {
  }, now{};
  return fd_ < 0 || (fstat(fd_, &own) == 0 && stat(folder_.c_str(), &now) == 0 && own.st_ino == now.st_ino &&
                     own.st_dev == now.st_dev);
}

bool IsFolderLocked(const std::filesystem::path& folder) {
  const int fd = OpenFolder(folder);
  if (fd < 0) return false;
  const bool locked = flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(fd);
  return locked;
}

std::vector<int> HeldFolderLocks() { return Held::Instance().All(); }

}  // namespace oraclegs
