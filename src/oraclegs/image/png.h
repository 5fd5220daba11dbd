#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

/// True when the bytes begin like a PNG.
bool IsPng(std::string_view bytes);

inline constexpr size_t kPngHeaderBytes = 33;  ///< bytes up to the checksum of the first chunk

/// Bits of a pixel of a PNG of one gray channel, from its header; 0 for all other bytes, a palette's, too.
int PngGrayBits(std::string_view head);

/// Decodes any PNG as 8-bit RGB, or RGBA when something in it is transparent. `file` names it in error messages. Throws
/// InputError when it is damaged or cut short, or when its header promises more pixels than its bytes can hold.
Image8 DecodePng(std::string_view bytes, const std::string& file);

/// The size, from the header.
void ReadPngSize(std::string_view bytes, const std::string& file, int* width, int* height);

/// 8 bit, 1, 3 or 4 channels, atomically. Throws RunError.
void WritePng(const std::filesystem::path& path, const Image8& image);

/// A 16-bit gray PNG (depth maps). Throws InputError naming the file when it is something else or damaged.
Image16 ReadPng16(const std::filesystem::path& path);

/// A 16-bit gray PNG; values are height * width.
void WritePng16(const std::filesystem::path& path, int width, int height, const std::vector<uint16_t>& values);

}  // namespace oraclegs
