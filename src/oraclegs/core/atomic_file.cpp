#include "oraclegs/core/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/host.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

fs::path FolderOf(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// Makes a rename in `dir` survive a power cut. File systems that cannot do it for folders say EINVAL.
void SyncFolder(const fs::path& dir) {
  const int fd = open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;  // a folder may be writable without being readable
  const int error = fsync(fd) == 0 ? 0 : errno;
  close(fd);
  if (error != 0 && error != EINVAL && error != ENOTSUP) {
    throw RunError("{}: cannot flush the folder to disk: {}", dir.string(), SystemReason(error));
  }
}

constexpr std::string_view kTemporaryPrefix = ".oraclegs-";
constexpr std::chrono::hours kLongestSilence{24};  // of a process that makes something

/// The process that makes a file of a temporary name.
struct Maker {
  pid_t pid = 0;     ///< 0 = the name does not say
  std::string host;  ///< "" = the name does not say
};

Maker MakerOf(const fs::path& path) {
  const std::string name = path.filename().string();
  Maker maker;
  const char* end = name.data() + name.size();
  const char* at = std::from_chars(name.data() + kTemporaryPrefix.size(), end, maker.pid).ptr;
  const size_t number = name.rfind('-');  // names of machines may have dashes
  if (at != end && *at == '@' && name.data() + number > at) maker.host.assign(at + 1, name.data() + number);
  return maker;
}

/// Whether a file, or one of a folder and below, was written to lately.
bool WasWrittenLately(const fs::path& path) {
  const auto limit = fs::file_time_type::clock::now() - kLongestSilence;
  std::error_code error;
  const auto is_new = [&](const fs::path& file) {
    const auto time = fs::last_write_time(file, error);
    return !error && time > limit;
  };
  if (is_new(path)) return true;
  for (fs::recursive_directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    if (!it->is_symlink(error) && is_new(it->path())) return true;
  }
  return false;
}

bool IsMadeNow(const fs::path& path) {
  const Maker maker = MakerOf(path);
  if (maker.pid <= 0) return false;
  if (!maker.host.empty() && maker.host != HostName()) return WasWrittenLately(path);
  return maker.pid != getpid() && (kill(maker.pid, 0) == 0 || errno == EPERM);
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path) : AtomicFile(FolderOf(path), path) {}

AtomicFile::AtomicFile(const fs::path& folder, const fs::path& path) : wanted_(path) {
  do {
    temporary_ = folder / TemporaryName();
    fd_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (fd_ < 0 && errno == EEXIST);  // left by a process that was killed and had our number
  if (fd_ < 0) Fail("cannot write", errno);
}

AtomicFile::~AtomicFile() {
  if (fd_ >= 0) close(fd_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::Append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = write(fd_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) Fail("cannot write", errno);
    bytes.remove_prefix(static_cast<size_t>(n));
  }
}

void AtomicFile::Flush() {
  if (fd_ < 0) return;
  if (fsync(fd_) != 0) Fail("cannot flush to disk", errno);
  Close();
}

void AtomicFile::Finish() {
  Flush();
  Rename();
  SyncFolder(FolderOf(wanted_));
}

void AtomicFile::FinishUnflushed() {
  Close();
  Rename();
}

void AtomicFile::Close() {
  if (fd_ >= 0 && close(std::exchange(fd_, -1)) != 0) Fail("cannot write", errno);
}

void AtomicFile::Rename() {
  if (rename(temporary_.c_str(), wanted_.c_str()) != 0) Fail("cannot write", errno);
  temporary_.clear();
}

void AtomicFile::Fail(const char* what, int error) const {
  RequireHeldFolderOf(wanted_);  // which says more than that a folder below it is missing
  throw RunError("{}: {}: {}", wanted_.string(), what, SystemReason(error));
}

std::string TemporaryName() {
  static std::atomic<uint64_t> count{0};
  return fmt::format("{}{}@{}-{}.tmp", kTemporaryPrefix, getpid(), HostName(), count++);
}

bool IsTemporaryName(const fs::path& path) {
  return path.filename().string().starts_with(kTemporaryPrefix) && path.extension() == ".tmp";
}

void RemoveLeftovers(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> leftovers;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!IsTemporaryName(it->path())) continue;
    it.disable_recursion_pending();
    if (!IsMadeNow(it->path())) leftovers.push_back(it->path());
  }
  for (const fs::path& leftover : leftovers) fs::remove_all(leftover, error);
}

}  // namespace oraclegs
