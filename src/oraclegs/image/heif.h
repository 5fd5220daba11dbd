#pragma once
// HEIC, HEIF and AVIF: what phones write today.

#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// True when the bytes begin like an image of this family.
bool IsHeif(std::string_view bytes);

/// Decodes the main image as 8-bit RGB, or RGBA when it has an alpha channel, turned as the file says: it stands
/// upright whatever its EXIF orientation is. Throws InputError naming `file` when it is damaged, or when libheif has no
/// decoder for its compression.
Image8 DecodeHeif(std::string_view bytes, const std::string& file);

/// The size that DecodeHeif would return, from the header.
void ReadHeifSize(std::string_view bytes, const std::string& file, int* width, int* height);

/// The EXIF block of the main image; empty when there is none, or the file is damaged.
std::string ReadHeifExif(std::string_view bytes);

}  // namespace oraclegs
