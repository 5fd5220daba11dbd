#pragma once
// Image files of any supported format.

#include <filesystem>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// Reads a JPEG or PNG (by content, not by name) as RGB or RGBA. 16-bit PNG is reduced to 8; palette, grey and CMYK
/// become RGB; transparency of any kind becomes an alpha channel. Throws InputError naming the file and the damage.
Image8 ReadImage(const std::filesystem::path& path, Orientation orientation = Orientation::kUpright);

/// Width and height as ReadImage would return them, from the header alone.
void ReadImageSize(const std::filesystem::path& path, int* width, int* height,
                   Orientation orientation = Orientation::kUpright);

/// True for .jpg .jpeg .png in any case.
bool HasImageExtension(const std::filesystem::path& path);

}  // namespace oraclegs
