#pragma once
// How a program that reads a folder knows that the one that writes it is still there.

#include <filesystem>

namespace oraclegs {

/// A lock on a folder, which ends with this object and with the process, however it ends. Whoever has it waits for
/// nobody but readers that look (IsFolderLocked), and those take a moment. It does not keep others from writing.
class FolderLock {
 public:
  /// Holds nothing, without an error, where the folder is not there, another process has it, or the file system has no
  /// locks.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  bool held() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// True when a FolderLock is held on `folder`, by this process or another; false where nobody can know.
bool IsFolderLocked(const std::filesystem::path& folder);

}  // namespace oraclegs
