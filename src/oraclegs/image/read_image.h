#pragma once
// Image files of any supported format.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "oraclegs/image/exif.h"
#include "oraclegs/image/gpano.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// Reads a JPEG, PNG, HEIC, AVIF, WebP or TIFF (by content, not by name) as RGB or RGBA. 10 and 16 bits are reduced to
/// 8; palette, gray and CMYK become RGB; transparency of any kind becomes an alpha channel. The EXIF orientation of a
/// PNG is not applied. Throws InputError naming the file and the damage.
Image8 ReadImage(const std::filesystem::path& path, Orientation orientation = Orientation::kUpright);

/// Width and height as ReadImage would return them, from the header: of most files 64 KB are read, more of a JPEG with
/// larger metadata, all of a WebP or where the size stands elsewhere; nothing of a file whose header was read before
/// and that has not changed since (core/file_facts.h).
void ReadImageSize(const std::filesystem::path& path, int* width, int* height,
                   Orientation orientation = Orientation::kUpright);

/// Facts that stand in the header of an image file.
struct ImageHeader {
  int width = 0, height = 0;                ///< as ReadImage would return them
  int stored_width = 0, stored_height = 0;  ///< as ReadImage would return them with Orientation::kAsStored
  std::string extension;                    ///< usual end of such a file's name, by its content: ".jpg"
  bool is_turned = false;                   ///< a JPEG that its EXIF orientation turns or mirrors
  bool may_be_transparent = false;          ///< a PNG of a kind with alpha, or a palette (whose entries may be)
  Projection projection = Projection::kPlain;
};

/// Reads of a file what ReadImageSize reads. Throws InputError naming it.
ImageHeader ReadImageHeader(const std::filesystem::path& path);

struct ImageInfo {
  int width = 0, height = 0;  ///< as ReadImage would return them
  Exif exif;
  std::string extension;  ///< usual end of such a file's name, by its content: ".jpg"
};

/// Reads size, EXIF and kind of an image without decoding its pixels; nothing of a file that was read so before and has
/// not changed since. Throws InputError naming the file.
ImageInfo ReadImageInfo(const std::filesystem::path& path);

inline constexpr size_t kImageHeadBytes = 16;  ///< enough for IsImage

/// True when the bytes begin like an image of a kind that ReadImage reads.
bool IsImage(std::string_view bytes);

/// True for .jpg .jpeg .jpe .jfif .mpo .png .heic .heif .hif .avif .webp .tif .tiff in any case.
bool HasImageExtension(const std::filesystem::path& path);

inline constexpr uint64_t kMaxImageBytes = uint64_t{1} << 31;  ///< of a file: the largest size without compression

/// An image file reduced to gray with its longer side at most `max_side`, as stored (EXIF does not turn it); a large
/// JPEG is not decoded in full. Throws InputError naming the file.
Image8 ReadGrayThumbnail(const std::filesystem::path& path, int max_side);

/// ReadGrayThumbnail of a file's bytes; `file` names it in error messages.
Image8 GrayThumbnail(const std::string& bytes, const std::string& file, int max_side);

}  // namespace oraclegs
