#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

/// What to photograph next for a better result: from sfm/registration.json, of photos without a pose or with a weak
/// one, then from the report, of places that are thinly supported. One sentence each, at most `most`. Files that are
/// missing or damaged say nothing.
std::vector<std::string> PhotoAdvice(const std::filesystem::path& workspace, size_t most);

/// Doubts about the poses that were found, as warnings of the registration say it. Files that are missing or
/// damaged say nothing.
std::vector<std::string> StoredPoseDoubts(const std::filesystem::path& workspace);

}  // namespace oraclegs
