#pragma once

#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// True when the bytes begin like a WebP.
bool IsWebp(std::string_view bytes);

/// Decodes a still WebP as RGB, or RGBA when it has an alpha channel. Throws InputError naming `file` when it is
/// damaged or an animation.
Image8 DecodeWebp(std::string_view bytes, const std::string& file, Orientation orientation);

/// The size that DecodeWebp would return, from the header.
void ReadWebpSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height);

}  // namespace oraclegs
