#include "oraclegs/core/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() {
    if (fd_ >= 0) close(fd_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int get() const { return fd_; }
  bool Close() { return close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

/// A new, uniquely named file of a folder that is gone at the end of the scope unless it was renamed. The name does not
/// contain the final one, which may be as long as a name can be.
class TemporaryFile {
 public:
  TemporaryFile(const fs::path& folder, const fs::path& wanted) : wanted_(wanted), fd_(Create(folder, &path_)) {
    if (fd_.get() < 0) Fail("cannot write", errno);
  }
  ~TemporaryFile() {
    if (!path_.empty()) unlink(path_.c_str());
  }

  void Write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = write(fd_.get(), bytes.data(), bytes.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) Fail("cannot write", errno);
      bytes.remove_prefix(static_cast<size_t>(n));
    }
    if (fsync(fd_.get()) != 0) Fail("cannot flush to disk", errno);
    if (!fd_.Close()) Fail("cannot write", errno);
  }

  void RenameToWanted() {
    if (rename(path_.c_str(), wanted_.c_str()) != 0) Fail("cannot write", errno);
    path_.clear();
  }

  [[noreturn]] void Fail(const char* what, int error) const {
    throw RunError("{}: {}: {}", wanted_.string(), what, std::strerror(error));
  }

 private:
  static int Create(const fs::path& folder, fs::path* path) {
    static std::atomic<uint64_t> count{0};
    while (true) {
      *path = folder / fmt::format(".oraclegs-{}-{}.tmp", getpid(), count++);
      const int fd = open(path->c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd < 0 && errno == EEXIST) continue;  // left by a process that was killed and had our number
      if (fd < 0) path->clear();
      return fd;
    }
  }

  fs::path wanted_;
  fs::path path_;
  FileDescriptor fd_;
};

void CreateFolders(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw RunError("{}: cannot create the folder: {}", dir.string(), error.message());
  if (!fs::is_directory(dir, error)) throw RunError("{}: is in the way, a folder is needed there", dir.string());
}

/// Makes a rename in `dir` survive a power cut. File systems that cannot do it for folders say EINVAL.
void SyncFolder(const fs::path& dir) {
  const FileDescriptor fd(open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0) return;  // a folder may be writable without being readable
  if (fsync(fd.get()) != 0 && errno != EINVAL && errno != ENOTSUP) {
    throw RunError("{}: cannot flush the folder to disk: {}", dir.string(), std::strerror(errno));
  }
}

}  // namespace

std::string ReadFile(const fs::path& path, uint64_t max_bytes) {
  const FileDescriptor fd(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // a pipe must not make us wait
  if (fd.get() < 0) throw InputError("{}: cannot open: {}", path.string(), std::strerror(errno));
  struct stat info {};
  if (fstat(fd.get(), &info) != 0) throw InputError("{}: cannot read: {}", path.string(), std::strerror(errno));
  if (S_ISDIR(info.st_mode)) throw InputError("{}: is a folder, a file is needed", path.string());
  if (!S_ISREG(info.st_mode)) throw InputError("{}: is not a regular file", path.string());
  const uint64_t size = static_cast<uint64_t>(info.st_size);
  if (size > max_bytes) {
    throw InputError("{}: has {} bytes, more than the {} such a file may have", path.string(), size, max_bytes);
  }
  std::string bytes(size, '\0');
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = read(fd.get(), bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw InputError("{}: cannot read: {}", path.string(), std::strerror(errno));
    if (n == 0) throw InputError("{}: became shorter while it was read; try again", path.string());
    done += static_cast<size_t>(n);
  }
  return bytes;
}

void WriteFileAtomically(const fs::path& path, std::string_view bytes) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  CreateFolders(folder);
  TemporaryFile file(folder, path);
  file.Write(bytes);
  file.RenameToWanted();
  SyncFolder(folder);
}

void RequireWritableFolder(const fs::path& dir) {
  CreateFolders(dir);
  TemporaryFile probe(dir, dir);
  probe.Write(std::string(4096, '\0'));  // a full disk still makes empty files
}

}  // namespace oraclegs
