#pragma once

#include <string>

namespace oraclegs {

/// `--version`: version and commit, then a line each of what computes and of the programs that are found here. Starts
/// no libtorch.
std::string VersionText();

/// The short hash of the commit, with "-dirty" when files were changed; "unknown" outside of a git checkout.
std::string_view CommitText();

}  // namespace oraclegs
