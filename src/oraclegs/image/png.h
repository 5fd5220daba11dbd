#pragma once

#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// True when the bytes begin like a PNG.
bool IsPng(std::string_view bytes);

/// Decodes any PNG as 8-bit RGB, or RGBA when something in it is transparent. `file` names it in error messages. Throws
/// InputError when it is damaged or cut short, or when its header promises more pixels than its bytes can hold.
Image8 DecodePng(std::string_view bytes, const std::string& file);

/// The size, from the header.
void ReadPngSize(std::string_view bytes, const std::string& file, int* width, int* height);

}  // namespace oraclegs
