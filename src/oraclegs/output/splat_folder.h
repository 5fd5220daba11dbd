#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

/// A splat and the file that it is to become.
struct SplatJob {
  std::filesystem::path from, to;
};

/// The splats that lie in a folder, by name, each with a file of the same name and another end in `out`: files whose
/// names end as those of a splat do, also of a format that is not read, folders of SOG, and workspaces with a splat.
/// Where both folders are one, files with that end are left out. Throws InputError when the folder holds none or cannot
/// be read; UsageError for an unknown end, and when two would become one file.
std::vector<SplatJob> SplatJobsOf(const std::filesystem::path& folder, const std::filesystem::path& out,
                                  const std::string& extension);

/// The job of one splat. Throws UsageError for an unknown end.
SplatJob SplatJobOf(const std::filesystem::path& splat, const std::filesystem::path& out, const std::string& extension);

}  // namespace oraclegs
