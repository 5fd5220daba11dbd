#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

/// Advice on photos that would improve the result, at most `most` sentences: first about photos without a pose or with
/// a weak one, from sfm/registration.json, then about places with little support, from the report. Missing or damaged
/// files give none.
std::vector<std::string> PhotoAdvice(const std::filesystem::path& workspace, size_t most);

/// Doubts about the poses that were found, in the words of the registration's warnings. Missing or damaged files give
/// none.
std::vector<std::string> StoredPoseDoubts(const std::filesystem::path& workspace);

}  // namespace oraclegs
