#include "oraclegs/core/file_lock.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>

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

}  // namespace oraclegs
