#pragma once
// How a program that uses a folder knows that another one writes it.

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

// Locks of whole files that other machines see, too, where they share the file system.

enum class FileLock {
  kLocked,
  kLockedByAnother,
  kUnknown,  ///< errno says why: a file system without locks
};

/// Locks an open file, which may be written, until it and its copies are closed, those of forked children among them.
/// It does not wait. Other open files of this process count as others.
FileLock TryLockFile(int fd);

/// True when a lock of TryLockFile is held on the file, but not by `fd` or a copy of it; false where nobody can know.
/// Reading is enough.
bool IsFileLocked(int fd);

/// False once the file that is open as `fd` was removed or another one has its name. Who locks a file that others may
/// rename or remove asks afterwards.
bool IsStillNamed(const std::filesystem::path& path, int fd);

/// Name of the file that is locked in place of its folder, which file systems of several machines cannot lock.
inline constexpr const char* kFolderLockName = ".oraclegs-lock";

/// A lock on a folder, seen by all machines that share it. It ends with this object and with the process, however it
/// ends; after a process that was killed, not before the programs that it started (core/process_group.h). It does not
/// keep others from writing.
class FolderLock {
 public:
  enum class State {
    kHeld,
    kHeldByAnother,
    kUnknown
  };  ///< unknown: no such folder, none that may be written, or a file system without locks

  /// Waits for another holder that long. Readers that look (IsFolderLocked) take microseconds.
  explicit FolderLock(const std::filesystem::path& folder,
                      std::chrono::milliseconds patience = std::chrono::milliseconds(100));
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;

  State state() const { return state_; }
  bool held() const { return state_ == State::kHeld; }

  /// Names another that holds it: "process 4711 on node7"; "another process" where that is not known.
  const std::string& holder() const { return holder_; }

  /// False once the folder was removed, or another one has its name, or the lock was removed from it.
  bool IsStillThere() const;

 private:
  void Lock(std::chrono::milliseconds patience);

  std::filesystem::path folder_;
  int folder_fd_ = -1;  ///< keeps its number from being given to another folder
  int fd_ = -1;         ///< the locked file
  State state_ = State::kUnknown;
  std::string holder_;
};

/// True when a FolderLock is held on `folder`, by this process or another; false where nobody can know.
bool IsFolderLocked(const std::filesystem::path& folder);

/// Throws RunError when `path` lies in a folder that this process holds and that was removed or replaced: making it
/// anew would leave a part of a run behind. Paths are compared as they are written.
void RequireHeldFolderOf(const std::filesystem::path& path);

/// Descriptors of the locks that this process holds.
std::vector<int> HeldFolderLocks();

}  // namespace oraclegs
