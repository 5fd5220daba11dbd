#pragma once
// How a program that uses a folder knows that another one writes it.

#include <chrono>
#include <filesystem>
#include <vector>

namespace oraclegs {

/// A lock on a folder, which ends with this object and with the process, however it ends, but not before the programs
/// that the process started (core/process_group.h). It does not keep others from writing.
class FolderLock {
 public:
  enum class State { kHeld, kHeldByAnother, kUnknown };  ///< unknown: no such folder, or a file system without locks

  /// Waits for another holder that long. Readers that look (IsFolderLocked) take microseconds.
  explicit FolderLock(const std::filesystem::path& folder,
                      std::chrono::milliseconds patience = std::chrono::milliseconds(100));
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;

  State state() const { return state_; }
  bool held() const { return state_ == State::kHeld; }

  /// False once the folder was removed or another one has its name.
  bool IsStillThere() const;

 private:
  std::filesystem::path folder_;
  int fd_ = -1;  ///< open, whether locked or not, unless another holds it
  State state_ = State::kUnknown;
};

/// True when a FolderLock is held on `folder`, by this process or another; false where nobody can know.
bool IsFolderLocked(const std::filesystem::path& folder);

/// Throws RunError when `path` lies in a folder that this process holds and that was removed or replaced: making it
/// anew would leave a part of a run behind. Paths are compared as they are written.
void RequireHeldFolderOf(const std::filesystem::path& path);

/// Descriptors of the locks that this process holds.
std::vector<int> HeldFolderLocks();

}  // namespace oraclegs
