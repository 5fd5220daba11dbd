#pragma once
// Files with poses that other programs wrote beside photos, under any name.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// The files that lie in a folder and whose names end so, sorted; hidden ones are left out.
std::vector<std::filesystem::path> FilesThatEnd(const std::filesystem::path& dir, std::string_view end);

/// The first 64 kB of a file, for telling what it is; without a byte order mark.
std::string HeadOfPoseFile(const std::filesystem::path& path);

/// Warns of photos that the program `file` comes from could not place.
void ReportUnplaced(const std::string& file, const std::vector<std::string>& names, const Listener& listener);

}  // namespace oraclegs
