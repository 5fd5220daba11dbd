#include "oraclegs/weights/part_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/interrupt.h"

namespace oraclegs {

PartFile::PartFile(const std::filesystem::path& to) : to_(to), path_(to.string() + ".part") {
  try {
    Open();
    std::vector<char> buffer(size_t{1} << 20);
    for (ssize_t n; (n = read(fd_, buffer.data(), buffer.size())) != 0;) {
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) Fail("cannot read");
      ThrowIfInterrupted();
      hash_.Add({buffer.data(), static_cast<size_t>(n)});
      size_ += static_cast<uint64_t>(n);
    }
  } catch (...) {
    if (fd_ >= 0) close(fd_);
    throw;
  }
}

void PartFile::Open() {
  while (true) {
    fd_ = open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd_ < 0) Fail("cannot write");
    const FileLock lock = TryLockFile(fd_);
    if (lock == FileLock::kUnknown) Fail("cannot lock");
    // Between opening and locking, another process may have finished the file: it has its final name and readers now.
    if (IsStillNamed(path_, fd_)) {
      if (lock == FileLock::kLocked) return;
      throw RunError("{}: another process is downloading it; wait for that one", path_.string());
    }
    close(std::exchange(fd_, -1));
  }
}

PartFile::~PartFile() { close(fd_); }

void PartFile::Append(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = write(fd_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) Fail("cannot write");
    hash_.Add(bytes.substr(0, static_cast<size_t>(n)));
    size_ += static_cast<uint64_t>(n);
    bytes.remove_prefix(static_cast<size_t>(n));
  }
}

void PartFile::Restart() {
  if (ftruncate(fd_, 0) != 0 || lseek(fd_, 0, SEEK_SET) != 0) Fail("cannot write");
  size_ = 0;
  hash_ = {};
}

void PartFile::Discard() { unlink(path_.c_str()); }

void PartFile::Finish() {
  if (fsync(fd_) != 0) Fail("cannot flush to disk");
  if (rename(path_.c_str(), to_.c_str()) != 0) Fail("cannot rename");
}

void PartFile::Fail(const char* what) const { throw RunError("{}: {}: {}", path_.string(), what, SystemReason(errno)); }

}  // namespace oraclegs
