#include "oraclegs/core/files.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "oraclegs/core/atomic_file.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/folder_lock.h"
#include "oraclegs/core/parallel.h"

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

 private:
  int fd_;
};

void CreateFolders(const fs::path& dir) {
  RequireHeldFolderOf(dir);
  std::error_code error;
  fs::create_directories(dir, error);
  if (error == std::errc::not_a_directory || error == std::errc::file_exists) {
    throw RunError("{}: is a file, or lies in one; name a folder", dir.string());
  }
  if (error) throw RunError("{}: cannot create the folder: {}", dir.string(), SystemReason(error));
  if (!fs::is_directory(dir, error)) throw RunError("{}: is in the way, a folder is needed there", dir.string());
}

constexpr size_t kMostToRead = size_t{64} << 20;  // bytes: takes a tenth of a second

struct Closer {
  int fd;
  ~Closer() { close(fd); }
};

MappedFile OwnBytes(const std::filesystem::path& path) {
  const auto bytes = std::make_shared<const std::string>(ReadFile(path, kMostToRead));
  return {*bytes, bytes};
}

bool IsProgram(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

/// The folder of the shared library that holds `function`, or of the program.
std::optional<fs::path> FolderOf(const void* function) {
  Dl_info info{};
  if (dladdr(function, &info) == 0 || info.dli_fname == nullptr) return std::nullopt;
  std::error_code ignored;
  const fs::path file = fs::canonical(info.dli_fname, ignored);
  if (file.empty()) return std::nullopt;
  return file.parent_path();
}

std::vector<fs::path> LibraryFolders() {
  std::vector<fs::path> folders;
  // The folder of liboraclegs_core.so, which the program and its libraries share, comes first.
  if (const auto core = FolderOf(reinterpret_cast<const void*>(&NumThreads))) folders.push_back(*core);
  std::error_code ignored;
  const fs::path program = fs::canonical("/proc/self/exe", ignored);
  if (program.empty()) return folders;
  for (const char* beside : {".", "../lib", "../lib/oraclegs"}) folders.push_back(program.parent_path() / beside);
  return folders;
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

std::string ReadHead(const fs::path& path, size_t bytes) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return "";  // a pipe must not make us wait
  std::string head(bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(std::max<std::streamsize>(0, file.gcount())));
  return head;
}

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

void WriteFileAtomically(const fs::path& path, std::string_view bytes) {
  CreateFolders(path.has_parent_path() ? path.parent_path() : fs::path("."));
  AtomicFile file(path);
  file.Append(bytes);
  file.Finish();
}

void ReplaceFile(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.Append(bytes);
  file.FinishUnflushed();
}

void RequireWritableFolder(const fs::path& dir) {
  CreateFolders(dir);
  AtomicFile probe(dir, dir);
  probe.Append(std::string(4096, '\0'));  // a full disk still makes empty files
  probe.Flush();
}

MappedFile MapFile(const std::filesystem::path& path) {
  const std::string name = path.string();
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) throw InputError("{}: cannot open: {}", name, std::strerror(errno));
  const Closer closer{fd};
  struct stat info {};
  if (fstat(fd, &info) != 0) throw InputError("{}: cannot read: {}", name, std::strerror(errno));
  if (!S_ISREG(info.st_mode)) throw InputError("{}: is not a regular file", name);
  const size_t size = static_cast<size_t>(info.st_size);
  if (size == 0) throw InputError("{}: is empty; get the file again", name);
  if (size <= kMostToRead) return OwnBytes(path);  // whoever cuts the file meanwhile cannot end us by SIGBUS
  void* address = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  if (address == MAP_FAILED) throw InputError("{}: cannot map into memory: {}", name, std::strerror(errno));
  MappedFile file;
  file.bytes = std::string_view(static_cast<const char*>(address), size);
  // munmap takes what mmap gave, the owner shows it read-only.
  file.owner = std::shared_ptr<const void>(address, [size](const void* a) { munmap(const_cast<void*>(a), size); });
  return file;
}

fs::path FindProgram(const std::string& name) {
  if (name.empty()) return {};
  if (name.find('/') != std::string::npos) return IsProgram(name) ? fs::absolute(name) : fs::path();
  const char* path = std::getenv("PATH");
  std::string_view folders = path ? path : "/usr/local/bin:/usr/bin:/bin";
  while (true) {
    const size_t colon = std::min(folders.find(':'), folders.size());
    const fs::path candidate = fs::path(colon == 0 ? "." : std::string(folders.substr(0, colon))) / name;
    if (IsProgram(candidate)) return fs::absolute(candidate);
    if (colon == folders.size()) return {};
    folders.remove_prefix(colon + 1);
  }
}

std::optional<fs::path> FindLibraryFile(const std::string& name) {
  for (const fs::path& folder : LibraryFolders()) {
    std::error_code ignored;
    if (fs::exists(folder / name, ignored)) return (folder / name).lexically_normal();
  }
  return std::nullopt;
}

}  // namespace oraclegs
