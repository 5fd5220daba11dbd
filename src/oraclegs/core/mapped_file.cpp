#include "oraclegs/core/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

constexpr size_t kMostToRead = size_t{64} << 20;  // bytes: takes a tenth of a second

struct Closer {
  int fd;
  ~Closer() { close(fd); }
};

MappedFile OwnBytes(const std::filesystem::path& path) {
  const auto bytes = std::make_shared<const std::string>(ReadFile(path, kMostToRead));
  return {*bytes, bytes};
}

}  // namespace

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

}  // namespace oraclegs
