#pragma once
// Options of a run that a command has, and those that its short help shows.

#include <string_view>
#include <vector>

namespace oraclegs {

/// Treatment of options that are of no use to the command.
enum class OtherOptions {
  kHidden,  ///< accepted: the command works on a workspace, whose stages share one set of options
  kNone,    ///< refused on the command line; a configuration file and a saved run may have them
};

struct RunScope {
  std::vector<std::string_view> without_groups;  ///< titles (RunOptions::ForEachGroup) that are of no use to it
  std::vector<std::string_view> with_options;    ///< options of those groups that are of use nevertheless
  std::vector<std::string_view> basic;           ///< in the short help
  OtherOptions others = OtherOptions::kHidden;

  bool Has(std::string_view group, std::string_view option) const;
  bool IsBasic(std::string_view option) const;
};

/// Scope of the command of this name.
const RunScope& RunScopeOf(std::string_view command);

}  // namespace oraclegs
