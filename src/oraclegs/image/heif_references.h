#pragma once

#include <string_view>

namespace oraclegs {

/// False where the main image of a HEIF file is made of itself, also over other images, or of more than 10 000 pieces:
/// libheif would decode them without end, and take memory for each.
bool HasFinitePieces(std::string_view heif);

}  // namespace oraclegs
