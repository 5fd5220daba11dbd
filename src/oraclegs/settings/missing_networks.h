#pragma once
// Networks that a run asks for by name and whose weights are not on this machine. They are reported before hours of
// work, all at once, or replaced.

#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// A part of the run whose network is missing.
struct MissingNetwork {
  std::string asked;                       ///< "--oracle vggt"
  std::vector<std::string> models;         ///< missing models, by their names in `oraclegs models`
  std::string names_a_file;                ///< "--vggt-weights"; empty where there is no such option
  std::string instead;                     ///< replacement without weights: "--oracle consistency"
  std::function<void(RunOptions*)> apply;  ///< switches to the replacement
};

/// Missing networks in the order of the stages, without those of parts that the run does not use. has_poses: the
/// scene's cameras are known. Throws InputError for an option that names a file which does not exist.
std::vector<MissingNetwork> MissingNetworks(const RunOptions& options, bool has_poses);

/// Returns the options unchanged when nothing is missing. Otherwise, with --allow-fallback, returns them with the
/// replacements, and gives a Warning of each; without it throws one InputError that lists all missing networks and the
/// commands that fetch them. Throws InputError, too, where another version of Stable Virtual Camera lies in the place
/// of the fetched one.
RunOptions WithNetworksAtHand(const RunOptions& options, bool has_poses, const Listener& listener);

}  // namespace oraclegs
