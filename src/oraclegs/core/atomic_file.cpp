#include "oraclegs/core/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/system_reason.h"

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

/// Of the process that makes a file of this name, ".oraclegs-PID-..."; 0 = the name does not say.
pid_t MakerOf(const fs::path& path) {
  const std::string name = path.filename().string();
  pid_t pid = 0;
  std::from_chars(name.data() + kTemporaryPrefix.size(), name.data() + name.size(), pid);
  return pid;
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path) : AtomicFile(FolderOf(path), path) {}

AtomicFile::AtomicFile(const fs::path& folder, const fs::path& path) : wanted_(path) {
  static std::atomic<uint64_t> count{0};
  do {
    temporary_ = folder / fmt::format("{}{}-{}.tmp", kTemporaryPrefix, getpid(), count++);
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
  throw RunError("{}: {}: {}", wanted_.string(), what, SystemReason(error));
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
    const pid_t maker = MakerOf(it->path());
    const bool is_made_now = maker > 0 && maker != getpid() && (kill(maker, 0) == 0 || errno == EPERM);
    if (!is_made_now) leftovers.push_back(it->path());
  }
  for (const fs::path& leftover : leftovers) fs::remove_all(leftover, error);
}

}  // namespace oraclegs
