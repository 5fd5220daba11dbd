#pragma once
// Export of one splat, as `export` and `convert` do it.

#include <filesystem>
#include <string>

#include "oraclegs/output/export.h"

namespace oraclegs {

/// Writes the splat of a workspace, or a splat file or folder of SOG, as the name of `out` says. Throws InputError for
/// another folder, and what ExportSplat throws.
ExportResult ExportOne(const std::filesystem::path& input, const std::filesystem::path& out,
                       const ExportOptions& options, const Listener& listener);

/// The line that reports the written file.
std::string LineOf(const std::filesystem::path& out, const ExportResult& result);

}  // namespace oraclegs
