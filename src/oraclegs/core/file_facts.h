#pragma once
// Facts about files, read once while they stay as they are: photos are asked for their size and content by many.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace oraclegs {

/// Stands for the state of a file: device, inode, size, and the times of its last changes in nanoseconds.
using FileState = std::array<int64_t, 5>;

/// Nothing for a file that cannot be looked at, or that changed within the last two seconds: file systems count time in
/// steps, so that it might change again unnoticed.
std::optional<FileState> StateOf(const std::filesystem::path& path);

/// Facts of one kind about files.
template <class Fact>
class FileFacts {
 public:
  /// The fact about a file, from `read` or, where the file is as it was then, from an earlier call. What `read` throws
  /// is passed on. Threads may ask at once.
  template <class Read>
  Fact Of(const std::filesystem::path& path, const Read& read) {
    const std::optional<FileState> state = StateOf(path);
    if (!state) return read();
    {
      const std::lock_guard lock(mutex_);
      const auto known = facts_.find(*state);
      if (known != facts_.end()) return known->second;
    }
    Fact fact = read();
    if (StateOf(path) != state) return fact;
    const std::lock_guard lock(mutex_);
    if (facts_.size() >= kMaxFacts) facts_.clear();
    facts_.insert_or_assign(*state, fact);
    return fact;
  }

 private:
  static constexpr size_t kMaxFacts = 100'000;

  std::mutex mutex_;
  std::map<FileState, Fact> facts_;
};

/// Checksums of a file's content.
struct FileDigest {
  uint64_t bytes = 0;
  uint32_t crc32 = 0;
  std::string sha256;  ///< of the content, followed by its length as 8 bytes, least first
};

/// Reads the file unless its state is that of an earlier call. Throws InputError naming it.
FileDigest DigestOf(const std::filesystem::path& path);

}  // namespace oraclegs
