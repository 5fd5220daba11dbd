#pragma once
// Pictures in memory and in files. Torch-free.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace oraclegs {

/// 8-bit picture, rows top to bottom, channels interleaved: 1 grey, 3 RGB, 4 RGBA (straight alpha).
struct Image8 {
  int width = 0, height = 0, channels = 0;
  std::vector<uint8_t> data;  ///< height * width * channels
};

/// The same as float in [0, 1].
struct ImageF {
  int width = 0, height = 0, channels = 0;
  std::vector<float> data;  ///< height * width * channels

  float* row(int y) { return data.data() + static_cast<size_t>(y) * width * channels; }
  const float* row(int y) const { return data.data() + static_cast<size_t>(y) * width * channels; }
};

enum class Orientation {
  kUpright,   ///< as the EXIF tag of a JPEG says
  kAsStored,  ///< the tag is ignored
};

/// Reads a JPEG or PNG (by content, not by name) as RGB or RGBA. 16-bit PNG is reduced to 8; palette, grey and CMYK
/// become RGB; transparency of any kind becomes an alpha channel. Throws InputError naming the file and the damage.
Image8 ReadImage(const std::filesystem::path& path, Orientation orientation = Orientation::kUpright);
/// Width and height as ReadImage would return them, from the header alone.
void ReadImageSize(const std::filesystem::path& path, int* width, int* height,
                   Orientation orientation = Orientation::kUpright);

/// PNG, 8 bit, 1, 3 or 4 channels, atomically. Throws RunError.
void WritePng(const std::filesystem::path& path, const Image8& image);
/// 16-bit grey picture (depth maps).
struct Image16 {
  int width = 0, height = 0;
  std::vector<uint16_t> values;  ///< height * width
};
/// Reads a 16-bit grey PNG. Throws InputError naming the file when it is something else or damaged.
Image16 ReadPng16(const std::filesystem::path& path);
/// 16-bit grey PNG (depth maps); values are height * width.
void WritePng16(const std::filesystem::path& path, int width, int height, const std::vector<uint16_t>& values);

/// True for .jpg .jpeg .png in any case.
bool HasImageExtension(const std::filesystem::path& path);

ImageF ToFloat(const Image8& image);
/// Clamps to [0,1] and rounds: floor(255 x + 0.5).
Image8 ToImage8(const ImageF& image);

/// Antialiased change of size: every new pixel is the exact area average of the old ones under it (an enlarged axis is
/// interpolated linearly). Intrinsics scale by new/old per axis.
ImageF ResizeArea(const ImageF& image, int width, int height);

}  // namespace oraclegs
