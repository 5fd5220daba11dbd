#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "oraclegs/core/progress.h"
#include "oraclegs/output/view/splat_site.h"

namespace oraclegs {

/// Folder that `oraclegs view` gives to the server (web/server.h).
class ViewSource {
 public:
  /// `input` is a workspace, whose run may be finished, going on or not yet begun, or a splat file. A workspace without
  /// a report (from `oraclegs train` or an older version) shows its splat only, with a note. Throws InputError naming a
  /// path that is neither, or damaged; UsageError for a file of an unknown format.
  ViewSource(const std::filesystem::path& input, const Listener& listener);

  const std::filesystem::path& root() const { return root_; }
  /// Kind of the source, for a line of output: "a finished run", "a run that goes on", ...
  const std::string& what() const { return what_; }

 private:
  void ShowWorkspace(const std::filesystem::path& workspace, const Listener& listener);
  void ShowFile(const std::filesystem::path& file, const Listener& listener);

  std::filesystem::path root_;
  std::string what_;
  std::optional<TemporaryFolder> temporary_;
};

}  // namespace oraclegs
