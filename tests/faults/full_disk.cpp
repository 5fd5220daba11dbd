// A full disk, for tests: in a program that is started with this library in LD_PRELOAD, and in its children, writing to
// files below a folder fails once a number of bytes were written there, all processes together.
//
//   FULL_DISK_FOLDER   the folder, as realpath gives it
//   FULL_DISK_STATE    a file of two numbers of 8 bytes: bytes written so far, and bytes that there is room for
//   FULL_DISK_ERRNO    what fails says so; ENOSPC unless given
//   FULL_DISK_NAMES    1: neither can a file, folder or link be made there then
//   FULL_DISK_LATE     1: as file systems that look for room later: writing works, fsync fails

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

struct State {
  std::atomic<uint64_t> written, room;
};

struct Settings {
  const char* folder = std::getenv("FULL_DISK_FOLDER");
  State* state = nullptr;
  int error = ENOSPC;
  bool names = std::getenv("FULL_DISK_NAMES") != nullptr, late = std::getenv("FULL_DISK_LATE") != nullptr;
};

template <class Function>
Function* Next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
#define NEXT(name) static auto* const next = Next<decltype(name)>(#name)

const Settings& Get() {
  static const Settings settings = [] {
    Settings made;
    if (const char* error = std::getenv("FULL_DISK_ERRNO")) made.error = std::atoi(error);
    const char* path = std::getenv("FULL_DISK_STATE");
    const int fd = path ? Next<int(const char*, int, ...)>("open")(path, O_RDWR | O_CLOEXEC) : -1;
    auto* const map = Next<void*(void*, size_t, int, int, int, off_t)>("mmap");  // ours asks this function
    void* const memory = fd < 0 ? MAP_FAILED : map(nullptr, sizeof(State), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (fd >= 0) close(fd);
    if (memory != MAP_FAILED) made.state = static_cast<State*>(memory);
    return made;
  }();
  return settings;
}

bool IsBelow(const char* path) {
  const Settings& settings = Get();
  if (settings.folder == nullptr || settings.state == nullptr) return false;
  const size_t length = std::strlen(settings.folder);
  return std::strncmp(path, settings.folder, length) == 0 && (path[length] == '/' || path[length] == '\0');
}

bool IsBelow(int fd) {
  char link[32], path[PATH_MAX];
  std::snprintf(link, sizeof(link), "/proc/self/fd/%d", fd);
  const ssize_t n = readlink(link, path, sizeof(path) - 1);
  if (n <= 0) return false;
  path[n] = '\0';
  return IsBelow(path);
}

/// By the name that a file will have: its folder is there.
bool WillBeBelow(int at, const char* path) {
  if (Get().state == nullptr) return false;
  char folder[PATH_MAX], real[PATH_MAX];
  if (path[0] == '/' || at == AT_FDCWD) {
    std::snprintf(folder, sizeof(folder), "%s", path);
  } else {
    std::snprintf(folder, sizeof(folder), "/proc/self/fd/%d/%s", at, path);
  }
  char* const slash = std::strrchr(folder, '/');
  if (slash == nullptr) {
    std::strcpy(folder, ".");
  } else {
    *slash = '\0';
  }
  return realpath(folder[0] == '\0' ? "/" : folder, real) != nullptr && IsBelow(real);
}

bool IsFull() {
  const State* const state = Get().state;
  return state != nullptr && state->written >= state->room;
}

/// How many of these bytes there is room for, which they then take.
size_t Take(int fd, size_t bytes) {
  if (!IsBelow(fd)) return bytes;
  State* const state = Get().state;
  const uint64_t before = state->written.fetch_add(bytes), room = state->room;
  if (Get().late) return bytes;
  return before >= room ? 0 : std::min<uint64_t>(bytes, room - before);
}

ssize_t NoRoom() {
  errno = Get().error;
  return -1;
}

bool RefusesName(int at, const char* path) { return Get().names && IsFull() && WillBeBelow(at, path); }

}  // namespace

extern "C" {

ssize_t write(int fd, const void* bytes, size_t size) {
  NEXT(write);
  const size_t room = Take(fd, size);
  return room == 0 && size > 0 ? NoRoom() : next(fd, bytes, room);
}

ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
  NEXT(pwrite);
  const size_t room = Take(fd, size);
  return room == 0 && size > 0 ? NoRoom() : next(fd, bytes, room, at);
}

ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t at) {
  NEXT(pwrite64);
  const size_t room = Take(fd, size);
  return room == 0 && size > 0 ? NoRoom() : next(fd, bytes, room, at);
}

ssize_t writev(int fd, const struct iovec* parts, int count) {
  NEXT(writev);
  size_t size = 0;
  for (int i = 0; i < count; ++i) size += parts[i].iov_len;
  const size_t room = Take(fd, size);
  if (room == size) return next(fd, parts, count);
  if (room == 0) return NoRoom();
  static auto* const plain = Next<decltype(write)>("write");
  return plain(fd, parts[0].iov_base, std::min(room, parts[0].iov_len));
}

size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  NEXT(fwrite);
  const int fd = fileno(file);
  if (size == 0 || count == 0 || fd < 0 || Take(fd, size * count) == size * count)
    return next(bytes, size, count, file);
  errno = Get().error;
  return 0;
}

ssize_t sendfile(int to, int from, off_t* at, size_t size) {
  static auto* const next = Next<ssize_t(int, int, off_t*, size_t)>("sendfile");
  struct stat info {};
  if (fstat(from, &info) == 0) size = std::min(size, static_cast<size_t>(info.st_size));
  const size_t room = Take(to, size);
  return room == 0 && size > 0 ? NoRoom() : next(to, from, at, room);
}

ssize_t copy_file_range(int from, off64_t* from_at, int to, off64_t* to_at, size_t size, unsigned flags) {
  NEXT(copy_file_range);
  struct stat info {};
  if (fstat(from, &info) == 0) size = std::min(size, static_cast<size_t>(info.st_size));
  const size_t room = Take(to, size);
  return room == 0 && size > 0 ? NoRoom() : next(from, from_at, to, to_at, room, flags);
}

int ftruncate(int fd, off_t size) {
  NEXT(ftruncate);
  struct stat info {};
  const bool grows = fstat(fd, &info) == 0 && size > info.st_size;
  return grows && IsFull() && IsBelow(fd) ? static_cast<int>(NoRoom()) : next(fd, size);
}

int ftruncate64(int fd, off64_t size) {
  NEXT(ftruncate64);
  struct stat info {};
  const bool grows = fstat(fd, &info) == 0 && size > info.st_size;
  return grows && IsFull() && IsBelow(fd) ? static_cast<int>(NoRoom()) : next(fd, size);
}

int posix_fallocate(int fd, off_t at, off_t size) {
  NEXT(posix_fallocate);
  return Take(fd, static_cast<size_t>(size)) == static_cast<size_t>(size) ? next(fd, at, size) : Get().error;
}

int posix_fallocate64(int fd, off64_t at, off64_t size) {
  NEXT(posix_fallocate64);
  return Take(fd, static_cast<size_t>(size)) == static_cast<size_t>(size) ? next(fd, at, size) : Get().error;
}

int fallocate(int fd, int mode, off_t at, off_t size) {
  NEXT(fallocate);
  return Take(fd, static_cast<size_t>(size)) == static_cast<size_t>(size) ? next(fd, mode, at, size)
                                                                          : static_cast<int>(NoRoom());
}

int fallocate64(int fd, int mode, off64_t at, off64_t size) {
  NEXT(fallocate64);
  return Take(fd, static_cast<size_t>(size)) == static_cast<size_t>(size) ? next(fd, mode, at, size)
                                                                          : static_cast<int>(NoRoom());
}

int fsync(int fd) {
  NEXT(fsync);
  return Get().late && IsFull() && IsBelow(fd) ? static_cast<int>(NoRoom()) : next(fd);
}

int fdatasync(int fd) {
  NEXT(fdatasync);
  return Get().late && IsFull() && IsBelow(fd) ? static_cast<int>(NoRoom()) : next(fd);
}

void* mmap(void* address, size_t size, int protection, int flags, int fd, off_t at) {
  static auto* const next = Next<void*(void*, size_t, int, int, int, off_t)>("mmap");
  const bool writes = fd >= 0 && (flags & MAP_SHARED) != 0 && (protection & PROT_WRITE) != 0;
  if (writes && IsBelow(fd) && IsFull()) return NoRoom(), MAP_FAILED;
  return next(address, size, protection, flags, fd, at);
}

int open(const char* path, int flags, ...) {
  static auto* const next = Next<int(const char*, int, ...)>("open");
  va_list more;
  va_start(more, flags);
  const auto mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if ((flags & O_CREAT) != 0 && access(path, F_OK) != 0 && RefusesName(AT_FDCWD, path))
    return static_cast<int>(NoRoom());
  return next(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  static auto* const next = Next<int(const char*, int, ...)>("open64");
  va_list more;
  va_start(more, flags);
  const auto mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if ((flags & O_CREAT) != 0 && access(path, F_OK) != 0 && RefusesName(AT_FDCWD, path))
    return static_cast<int>(NoRoom());
  return next(path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  NEXT(fopen);
  if (mode[0] != 'r' && access(path, F_OK) != 0 && RefusesName(AT_FDCWD, path)) return NoRoom(), nullptr;
  return next(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  NEXT(fopen64);
  if (mode[0] != 'r' && access(path, F_OK) != 0 && RefusesName(AT_FDCWD, path)) return NoRoom(), nullptr;
  return next(path, mode);
}

int mkdir(const char* path, mode_t mode) {
  NEXT(mkdir);
  return access(path, F_OK) != 0 && RefusesName(AT_FDCWD, path) ? static_cast<int>(NoRoom()) : next(path, mode);
}

int symlink(const char* target, const char* path) {
  NEXT(symlink);
  return RefusesName(AT_FDCWD, path) ? static_cast<int>(NoRoom()) : next(target, path);
}

}  // extern "C"
