#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "oraclegs/formats/values.h"

namespace oraclegs {

/// A .sog file of version 2 (sog_writer.h). Throws InputError naming `file`: no zip, no meta.json or one of another
/// version, images that are missing, damaged, or of another size than the number of Gaussians asks for.
GaussianPly DecodeSog(std::string_view bytes, const std::string& file);

/// True for a folder with the files of such an archive side by side: meta.json and its images.
bool IsSogFolder(const std::filesystem::path& folder);
/// Reads it, with the same errors.
GaussianPly ReadSogFolder(const std::filesystem::path& folder);

}  // namespace oraclegs
