#pragma once
// The library of the app: a folder of projects, addressed by numbers that are no names.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/app/project.h"
#include "oraclegs/core/folder_lock.h"

namespace oraclegs {

/// A folder of the library.
struct Project {
  std::string id;  ///< 16 hexadecimal digits, the same at each start
  ProjectPaths paths;
  bool is_foreign = false;  ///< the workspace of a run from a command line: shown, not changed
  ProjectRecord record;
  std::string problem;  ///< why it could not be started, of this app's time alone: the disk may take nothing
  /// Workspace of the run.
  std::filesystem::path splat() const { return is_foreign ? paths.root() : paths.splat(); }
};

/// Safe to call from any thread.
class Library {
 public:
  /// Opens or makes the folder, and holds it against a second app. Throws RunError when it cannot be written or is
  /// held.
  explicit Library(std::filesystem::path root);

  const std::filesystem::path& root() const { return root_; }

  /// All projects, in the order of their folders' names. Links are not followed.
  std::vector<Project> Projects() const;
  std::optional<Project> Find(const std::string& id) const;
  /// Makes a folder for a project of that name. Throws RunError.
  Project Create(const std::string& name);
  /// Changes a record and writes it. Throws RunError; InputError when there is no such project of the app.
  void Update(const std::string& id, const std::function<void(ProjectRecord*)>& change);
  /// Says why a project cannot be started; "" where nothing is wrong.
  void SetProblem(const std::string& id, const std::string& problem);
  /// Moves the folder to the desktop's trash; false where there is none.
  bool Trash(const Project& project) const;
  /// Removes the folder for good. Throws RunError.
  void Remove(const Project& project) const;

  /// Bytes that can still be written; 0 where that is not known.
  uint64_t FreeBytes() const;

 private:
  std::optional<Project> In(const std::filesystem::path& folder) const;

  std::filesystem::path root_;
  std::optional<FolderLock> lock_;
  mutable std::mutex mutex_;
  std::map<std::string, std::string> problems_;  ///< by the project's id
};

/// Number of a file or folder by its name, as 16 hexadecimal digits.
std::string IdOf(const std::string& name);

}  // namespace oraclegs
