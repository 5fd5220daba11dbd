#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "oraclegs/core/progress.h"
#include "oraclegs/output/view/splat_site.h"

namespace oraclegs {

/// What `oraclegs view` shows: a folder for the server (web/server.h).
class ViewSource {
 public:
  /// `input`: a workspace, whether its run is finished, going on, or not yet there; or a splat file. A workspace
  /// without a report, of `oraclegs train` or an older version, shows its splat alone, which a note says. Throws
  /// InputError naming what is neither, or damaged; UsageError for a file of no known format.
  ViewSource(const std::filesystem::path& input, const Listener& listener);

  const std::filesystem::path& root() const { return root_; }
  /// What it is, for a line of output: "a finished run", "a run that goes on", ...
  const std::string& what() const { return what_; }

 private:
  void ShowWorkspace(const std::filesystem::path& workspace, const Listener& listener);
  void ShowFile(const std::filesystem::path& file, const Listener& listener);

  std::filesystem::path root_;
  std::string what_;
  std::optional<TemporaryFolder> temporary_;
};

}  // namespace oraclegs
