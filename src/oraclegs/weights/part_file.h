#pragma once
// A file that has arrived in part, and its checksum so far.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "oraclegs/core/sha256.h"

namespace oraclegs {

/// TO.part, open for appending and locked against other processes. Stays on disk unless it is renamed or discarded.
class PartFile {
 public:
  /// Opens or makes it, and reads what is there into the checksum. Throws RunError naming it.
  explicit PartFile(const std::filesystem::path& to);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  uint64_t size() const { return size_; }
  std::string Sha256Hex() const { return hash_.Hex(); }
  /// Throws RunError (disk full).
  void Append(std::string_view bytes);
  /// Forgets all that has arrived.
  void Restart();
  /// Removes it; to be called when its content is wrong.
  void Discard();
  /// Flushes to disk and gives it its final name.
  void Finish();

 private:
  /// The file of this name, locked.
  void Open();
  [[noreturn]] void Fail(const char* what) const;

  std::filesystem::path to_, path_;
  int fd_ = -1;
  uint64_t size_ = 0;
  Sha256 hash_;
};

}  // namespace oraclegs
