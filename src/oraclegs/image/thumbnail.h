#pragma once

#include <filesystem>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// An image file reduced to gray with its longer side at most `max_side`, as stored (EXIF does not turn it); a large
/// JPEG is not decoded in full. Throws InputError naming the file.
Image8 ReadGrayThumbnail(const std::filesystem::path& path, int max_side);

}  // namespace oraclegs
