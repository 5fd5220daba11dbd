#pragma once

#include <filesystem>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// True when the file begins like a zip archive.
bool IsZip(const std::filesystem::path& path);

/// How many photos (by content) the archive has. Throws InputError naming it when it is no archive, has none, has more
/// than one scene may have, is encrypted, or promises more bytes than photos of its size have: four times its own and
/// 64 MB.
int CountZipPhotos(const std::filesystem::path& archive);

/// Unpacks the photos of an archive below `dir`, in the folders they have in the archive; names that lead out of it
/// lead to `dir`. Files that look like photos or videos and are not read are named to `listener` and not left there.
/// Throws InputError naming the archive when it is damaged, holds nothing that can be read, or unpacks to more than
/// CountZipPhotos allows, RunError when `dir` cannot be written or has too little room.
void UnpackPhotos(const std::filesystem::path& archive, const std::filesystem::path& dir, const Listener& listener);

}  // namespace oraclegs
