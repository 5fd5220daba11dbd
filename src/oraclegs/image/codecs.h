#pragma once
// The formats of image files: JPEG, PNG, HEIF, WebP and TIFF.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

inline constexpr int kPreviewQuality = 90;  ///< of JPEGs that are there to be looked at

/// True when the bytes begin like a PNG.
bool IsPng(std::string_view bytes);

inline constexpr size_t kPngHeaderBytes = 33;  ///< of a PNG, up to the checksum of its first chunk

/// Bits of a pixel of a PNG of one gray channel, from its header; 0 for all other bytes, a palette's, too.
int PngGrayBits(std::string_view head);

/// True for a PNG with an alpha channel or a palette, whose entries may be transparent, from its header.
bool PngMayBeTransparent(std::string_view head);

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

/// True when the bytes begin like HEIC, HEIF or AVIF: what phones write today.
bool IsHeif(std::string_view bytes);

/// Decodes the main image as 8-bit RGB, or RGBA when it has an alpha channel, turned as the file says: it stands
/// upright whatever its EXIF orientation is. Throws InputError naming `file` when it is damaged, or when libheif has no
/// decoder for its compression.
Image8 DecodeHeif(std::string_view bytes, const std::string& file);

/// The size that DecodeHeif would return, from the header.
void ReadHeifSize(std::string_view bytes, const std::string& file, int* width, int* height);

/// The EXIF block of the main image; empty when there is none, or the file is damaged.
std::string ReadHeifExif(std::string_view bytes);

/// False where the main image of a HEIF file is made of itself, also over other images, or of more than 10 000 pieces:
/// libheif would decode them without end, and take memory for each.
bool HasFinitePieces(std::string_view heif);

/// True when the bytes begin like a WebP.
bool IsWebp(std::string_view bytes);

/// Decodes a still WebP as RGB, or RGBA when it has an alpha channel. Throws InputError naming `file` when it is
/// damaged or an animation.
Image8 DecodeWebp(std::string_view bytes, const std::string& file, Orientation orientation);

/// The size that DecodeWebp would return, from the header.
void ReadWebpSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height);

/// True when the bytes begin like a TIFF.
bool IsTiff(std::string_view bytes);

/// Decodes the first page of a TIFF, of 8 or 16 bits and any of the usual compressions, as 8-bit RGB, or RGBA when
/// something in it is transparent. Throws InputError naming `file` when it is damaged, or of a kind that photos are not
/// stored in (32-bit floats).
Image8 DecodeTiff(std::string_view bytes, const std::string& file, Orientation orientation);

/// The size that DecodeTiff would return, from the header.
void ReadTiffSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height);

}  // namespace oraclegs
