#pragma once
// Locks of whole files that other machines see, too, where they share the file system.

#include <filesystem>

namespace oraclegs {

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

}  // namespace oraclegs
