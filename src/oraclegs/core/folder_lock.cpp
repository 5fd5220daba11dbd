#include "oraclegs/core/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr std::chrono::milliseconds kPause(2);

int OpenFolder(const std::filesystem::path& folder) { return open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); }

bool IsStillThere(const std::filesystem::path& folder, int fd) {
  struct stat own {
  }, now{};
  return fstat(fd, &own) == 0 && stat(folder.c_str(), &now) == 0 && own.st_ino == now.st_ino &&
         own.st_dev == now.st_dev;
}

bool LiesIn(const std::filesystem::path& folder, const std::filesystem::path& path) {
  const std::string whole = path.string(), start = folder.string();
  return whole.starts_with(start) && (whole.size() == start.size() || whole[start.size()] == '/');
}

/// Held locks by their descriptors.
class Held {
 public:
  static Held& Instance() {
    static Held held;
    return held;
  }
  void Add(int fd, const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex_);
    folders_[fd] = folder;
  }
  void Remove(int fd) {
    const std::lock_guard lock(mutex_);
    folders_.erase(fd);
  }
  std::map<int, std::filesystem::path> All() {
    const std::lock_guard lock(mutex_);
    return folders_;
  }

 private:
  std::mutex mutex_;
  std::map<int, std::filesystem::path> folders_;
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
  Held::Instance().Add(fd_, folder_);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : folder_(std::move(other.folder_)),
      fd_(std::exchange(other.fd_, -1)),
      state_(std::exchange(other.state_, State::kUnknown)) {}

FolderLock::~FolderLock() {
  if (held()) Held::Instance().Remove(fd_);
  if (fd_ >= 0) close(fd_);
}

bool FolderLock::IsStillThere() const { return fd_ < 0 || oraclegs::IsStillThere(folder_, fd_); }

void RequireHeldFolderOf(const std::filesystem::path& path) {
  for (const auto& [fd, folder] : Held::Instance().All()) {
    if (!LiesIn(folder, path) || IsStillThere(folder, fd)) continue;
    throw RunError("{}: was removed or replaced while the run was working there; run the same command again",
                   folder.string());
  }
}

bool IsFolderLocked(const std::filesystem::path& folder) {
  const int fd = OpenFolder(folder);
  if (fd < 0) return false;
  const bool locked = flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(fd);
  return locked;
}

std::vector<int> HeldFolderLocks() {
  std::vector<int> fds;
  for (const auto& [fd, folder] : Held::Instance().All()) fds.push_back(fd);
  return fds;
}

}  // namespace oraclegs
