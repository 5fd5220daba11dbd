#pragma once
// A file that is written in pieces and appears under its name when it is whole.

#include <filesystem>
#include <string>
#include <string_view>

namespace oraclegs {

/// A uniquely named file of the folder of `path`, which is gone at the end of the scope unless it was finished. Its
/// name does not contain the final one, which may be as long as a name can be.
class AtomicFile {
 public:
  /// The folder must be there. Throws RunError naming `path` and the reason, as all of this class.
  explicit AtomicFile(const std::filesystem::path& path);
  /// The temporary file stands in `folder`, whatever `path` is; errors name `path`.
  AtomicFile(const std::filesystem::path& folder, const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Append(std::string_view bytes);
  /// Flushes to disk and closes the file, which has its temporary name still.
  void Flush();
  /// Flush, and gives it its final name, in place of what had that name before.
  void Finish();
  /// Finishes without waiting for the disk: readers see all of the old or the new file, but a power cut may lose both.
  void FinishUnflushed();

 private:
  void Close();
  void Rename();
  [[noreturn]] void Fail(const char* what, int error) const;

  std::filesystem::path wanted_, temporary_;
  int fd_ = -1;
};

/// A name for a file or folder that is not finished, ".oraclegs-PID@HOST-N.tmp", another one each time in this process.
std::string TemporaryName();

/// True for the name of a file or folder that is not finished: of AtomicFile, and of folders that are made like it.
bool IsTemporaryName(const std::filesystem::path& path);

/// Removes what processes that were killed left unfinished in `folder` and below. What a process that runs is making
/// stays, and so does what cannot be removed. Whether a process of another machine runs is not known: what it has
/// written to within a day stays. Links are not followed.
void RemoveLeftovers(const std::filesystem::path& folder);

}  // namespace oraclegs
