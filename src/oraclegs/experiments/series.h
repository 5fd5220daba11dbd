#pragma once
// Helpers of all series of runs: a folder that is theirs, and events without repetition.

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Files that a series writes to its folder.
struct SeriesFiles {
  const char* what;                     ///< "ablation"
  const char* report;                   ///< its JSON file
  std::vector<std::string_view> names;  ///< names of all its files and folders
};

/// Throws InputError when `out` holds anything but such a series, or a report of another program.
void RequireSeriesFolder(const std::filesystem::path& out, const SeriesFiles& files);

class SeriesListener {
 public:
  /// `listener` must outlive it.
  explicit SeriesListener(const Listener& listener) : listener_(listener) {}

  /// Listener for the next run, valid while this object lives. `where` ("row 2, seed 0: ") is put before the names of
  /// its stages. Only notes of the first run are passed on, and each warning once.
  Listener ForRun(const std::string& where);

 private:
  const Listener& listener_;
  std::set<std::string> warned_;
  bool first_ = true;
};

}  // namespace oraclegs
