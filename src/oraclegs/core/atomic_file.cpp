#include "oraclegs/core/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include "oraclegs/core/error.h"

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
    throw RunError("{}: cannot flush the folder to disk: {}", dir.string(), std::strerror(error));
  }
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path) : AtomicFile(FolderOf(path), path) {}

AtomicFile::AtomicFile(const fs::path& folder, const fs::path& path) : wanted_(path) {
  static std::atomic<uint64_t> count{0};
  do {
    temporary_ = folder / fmt::format(".oraclegs-{}-{}.tmp", getpid(), count++);
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
  throw RunError("{}: {}: {}", wanted_.string(), what, std::strerror(error));
}

}  // namespace oraclegs
