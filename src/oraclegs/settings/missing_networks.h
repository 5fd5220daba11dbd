#pragma once
// Networks that a run asks for by name and whose weights are not on this machine: reported before hours of work, all at
// once, or done without.

#include <functional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// A part of the run that cannot be as it was asked for.
struct MissingNetwork {
  std::string asked;                       ///< "--oracle vggt"
  std::vector<std::string> models;         ///< what is missing, as `oraclegs models` names it
  std::string names_a_file;                ///< "--vggt-weights"; empty where there is no such option
  std::string instead;                     ///< what needs no weights: "--oracle consistency"
  std::function<void(RunOptions*)> apply;  ///< makes it so
};

/// In the order of the stages; parts that the run does not come to are not among them. has_poses: the scene's cameras
/// are known. Throws InputError for an option that names a file which is not there.
std::vector<MissingNetwork> MissingNetworks(const RunOptions& options, bool has_poses);

/// The options when nothing is missing. Else, with --allow-fallback, the options with what needs no weights instead,
/// and a Warning of each; without, throws one InputError that lists all that is missing and the commands that bring it.
RunOptions WithNetworksAtHand(const RunOptions& options, bool has_poses, const Listener& listener);

}  // namespace oraclegs
