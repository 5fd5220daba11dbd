#pragma once

#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// True when the bytes begin like a TIFF.
bool IsTiff(std::string_view bytes);

/// Decodes the first page of a TIFF, of 8 or 16 bits and any of the usual compressions, as 8-bit RGB, or RGBA when
/// something in it is transparent. Throws InputError naming `file` when it is damaged, or of a kind that photos are not
/// stored in (32-bit floats).
Image8 DecodeTiff(std::string_view bytes, const std::string& file, Orientation orientation);

/// The size that DecodeTiff would return, from the header.
void ReadTiffSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height);

}  // namespace oraclegs
