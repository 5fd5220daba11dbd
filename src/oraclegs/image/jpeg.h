#pragma once

#include <string>
#include <string_view>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// True when the bytes begin like a JPEG.
bool IsJpeg(std::string_view bytes);

/// Decodes a baseline or progressive JPEG as RGB. `file` names it in error messages. Throws InputError when it is
/// damaged or cut short, or when its header promises more pixels than its bytes can hold.
Image8 DecodeJpeg(std::string_view bytes, const std::string& file, Orientation orientation);

/// Decodes as gray, as stored, at the smallest of the sizes a JPEG offers (1/8 to 1) whose longer side is at least
/// `min_side`. Throws as DecodeJpeg.
Image8 DecodeReducedJpeg(std::string_view bytes, const std::string& file, int min_side);

/// The size that DecodeJpeg would return, from the header.
void ReadJpegSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height);

/// The bytes of a JPEG; 1 or 3 channels; quality 1 to 100. Throws RunError.
std::string CompressJpeg(const Image8& image, int quality);

}  // namespace oraclegs
