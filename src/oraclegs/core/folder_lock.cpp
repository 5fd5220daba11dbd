#include "oraclegs/core/folder_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/host.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

// OFD locks belong to an open file and not to a process, as flock does; but NFS hands them to its server for every kind
// of client, and flock of a folder to nobody.
struct flock WholeFile() {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return whole;
}

constexpr std::chrono::milliseconds kPause(2);

std::filesystem::path LockOf(const std::filesystem::path& folder) { return folder / kFolderLockName; }

/// Says in the lock who has it. Where that cannot be written, others know less.
void Sign(int fd) {
  const std::string text = fmt::format("{} {}\n", getpid(), HostName());
  [[maybe_unused]] const bool is_signed = ftruncate(fd, 0) == 0 && pwrite(fd, text.data(), text.size(), 0) > 0;
}

std::string HolderIn(int fd) {
  std::array<char, 256> bytes{};
  const ssize_t read = pread(fd, bytes.data(), bytes.size(), 0);
  std::istringstream text(std::string(bytes.data(), read > 0 ? static_cast<size_t>(read) : 0));
  int64_t pid = 0;
  std::string host;
  if (!(text >> pid >> host)) return "another process";
  return fmt::format("process {} on {}", pid, Printable(host, 64));
}

/// Descriptor of a held lock, and what is known by it.
struct HeldLock {
  std::filesystem::path folder;
  int folder_fd = -1;
};

bool IsThere(const HeldLock& lock, int fd) {
  // Links to the folder are followed.
  return IsStillNamed(lock.folder / ".", lock.folder_fd) && IsStillNamed(LockOf(lock.folder), fd);
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
  void Add(int fd, HeldLock held) {
    const std::lock_guard lock(mutex_);
    locks_[fd] = std::move(held);
  }
  void Remove(int fd) {
    const std::lock_guard lock(mutex_);
    locks_.erase(fd);
  }
  std::map<int, HeldLock> All() {
    const std::lock_guard lock(mutex_);
    return locks_;
  }

 private:
  std::mutex mutex_;
  std::map<int, HeldLock> locks_;
};

}  // namespace

FileLock TryLockFile(int fd) {
  struct flock whole = WholeFile();
  while (fcntl(fd, F_OFD_SETLK, &whole) != 0) {
    if (errno == EINTR) continue;
    return errno == EAGAIN || errno == EACCES ? FileLock::kLockedByAnother : FileLock::kUnknown;
  }
  return FileLock::kLocked;
}

bool IsFileLocked(int fd) {
  struct flock whole = WholeFile();
  return fcntl(fd, F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
}

bool IsStillNamed(const std::filesystem::path& path, int fd) {
  struct stat own {
  }, now{};
  return fstat(fd, &own) == 0 && lstat(path.c_str(), &now) == 0 && own.st_ino == now.st_ino && own.st_dev == now.st_dev;
}

FolderLock::FolderLock(const std::filesystem::path& folder, std::chrono::milliseconds patience) : folder_(folder) {
  folder_fd_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_fd_ < 0) return;
  Lock(patience);
  if (!held()) return;
  Sign(fd_);
  Held::Instance().Add(fd_, {folder_, folder_fd_});
}

void FolderLock::Lock(std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  const std::filesystem::path path = LockOf(folder_);
  while (true) {
    const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd < 0) {  // perhaps another user's
      if (IsFolderLocked(folder_)) state_ = State::kHeldByAnother, holder_ = "another process";
      return;
    }
    const FileLock lock = TryLockFile(fd);
    const bool named = IsStillNamed(path, fd);  // else it was let go, and removed, between our two looks
    if (lock == FileLock::kLocked && named) {
      fd_ = fd;
      state_ = State::kHeld;
      return;
    }
    if (lock == FileLock::kUnknown) {
      if (named) unlink(path.c_str());
      close(fd);
      return;
    }
    const bool late = std::chrono::steady_clock::now() >= deadline;
    if (lock == FileLock::kLockedByAnother && late) state_ = State::kHeldByAnother, holder_ = HolderIn(fd);
    close(fd);
    if (state_ == State::kHeldByAnother) return;
    if (lock == FileLock::kLockedByAnother) std::this_thread::sleep_for(kPause);
  }
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : folder_(std::move(other.folder_)),
      folder_fd_(std::exchange(other.folder_fd_, -1)),
      fd_(std::exchange(other.fd_, -1)),
      state_(std::exchange(other.state_, State::kUnknown)),
      holder_(std::move(other.holder_)) {}

FolderLock::~FolderLock() {
  if (fd_ >= 0) {
    Held::Instance().Remove(fd_);
    const std::filesystem::path path = LockOf(folder_);
    if (IsStillNamed(path, fd_)) unlink(path.c_str());
    close(fd_);
  }
  if (folder_fd_ >= 0) close(folder_fd_);
}

bool FolderLock::IsStillThere() const {
  if (fd_ >= 0) return IsThere({folder_, folder_fd_}, fd_);
  return folder_fd_ < 0 || IsStillNamed(folder_ / ".", folder_fd_);
}

void RequireHeldFolderOf(const std::filesystem::path& path) {
  for (const auto& [fd, lock] : Held::Instance().All()) {
    if (!LiesIn(lock.folder, path) || IsThere(lock, fd)) continue;
    throw RunError("{}: was removed or replaced while the run was working there; run the same command again",
                   lock.folder.string());
  }
}

bool IsFolderLocked(const std::filesystem::path& folder) {
  const int fd = open(LockOf(folder).c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = IsFileLocked(fd);
  close(fd);
  return locked;
}

std::vector<int> HeldFolderLocks() {
  std::vector<int> fds;
  for (const auto& [fd, lock] : Held::Instance().All()) fds.push_back(fd);
  return fds;
}

}  // namespace oraclegs
