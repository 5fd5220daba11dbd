#pragma once
// What all series of runs need: a folder that is theirs, and events without what every run reports alike.

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// What a series writes to its folder.
struct SeriesFiles {
  const char* what;                     ///< "ablation"
  const char* report;                   ///< its JSON file
  std::vector<std::string_view> names;  ///< of all its files and folders
};

/// Throws InputError when `out` holds anything but such a series, or a report of another program.
void RequireSeriesFolder(const std::filesystem::path& out, const SeriesFiles& files);

class SeriesListener {
 public:
  /// `listener` must outlive it.
  explicit SeriesListener(const Listener& listener) : listener_(listener) {}

  /// For the next run, as long as this lives. `where` ("row 2, seed 0: ") stands before the names of its stages. Notes
  /// of the first run alone are passed on, and each warning once.
  Listener ForRun(const std::string& where);

 private:
  const Listener& listener_;
  std::set<std::string> warned_;
  bool first_ = true;
};

}  // namespace oraclegs
