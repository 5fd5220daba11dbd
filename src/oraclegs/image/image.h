#pragma once
// Images in memory. codecs.h and read_image.h read and write them.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace oraclegs {

/// 8-bit image, rows top to bottom, channels interleaved: 1 gray, 3 RGB, 4 RGBA (straight alpha).
struct Image8 {
  int width = 0, height = 0, channels = 0;
  std::vector<uint8_t> data;  ///< height * width * channels
};

/// Pixels as floats in [0, 1], laid out as those of Image8.
struct ImageF {
  int width = 0, height = 0, channels = 0;
  std::vector<float> data;  ///< height * width * channels

  float* row(int y) { return data.data() + static_cast<size_t>(y) * width * channels; }
  const float* row(int y) const { return data.data() + static_cast<size_t>(y) * width * channels; }
};

/// 16-bit gray image (depth maps).
struct Image16 {
  int width = 0, height = 0;
  std::vector<uint16_t> values;  ///< height * width
};

enum class Orientation {
  kUpright,   ///< as the EXIF tag says, or the file itself (HEIF)
  kAsStored,  ///< the tag is ignored
};

inline constexpr int64_t kUsualMaxMegapixels = 268;    ///< beyond what cameras take
inline constexpr int64_t kLargestMaxMegapixels = 500;  ///< a byte of such an image still has a number of 31 bits

/// Image files of more pixels are refused from now on: a file of some kilobytes can promise them. A setting of the
/// machine, as SetNumThreads is.
void SetMaxMegapixels(int64_t megapixels);

/// Throws InputError when an image file's header gives no size, one that is too large (SetMaxMegapixels), or more than
/// the `possible` pixels that its bytes can hold: memory is reserved only after this.
void CheckImageSize(int64_t width, int64_t height, uint64_t possible, const std::string& file);

ImageF ToFloat(const Image8& image);
/// Clamps to [0,1] and rounds: floor(255 x + 0.5).
Image8 ToImage8(const ImageF& image);

/// Antialiased change of size: every new pixel is the exact area average of the old ones under it (an enlarged axis is
/// interpolated linearly). Intrinsics scale by new/old per axis.
ImageF ResizeArea(const ImageF& image, int width, int height);

/// Pillow's bicubic filter (antialiased when shrinking, 8 bits between the passes), bit for bit. Throws ShapeError when
/// a size is not positive.
Image8 ResizeLikePillow(const Image8& image, int width, int height);

/// ResizeLikePillow of an image whose first three channels are colors: these as bytes, cut off and not rounded, as they
/// are where the public code of [Kerbl 2023] composites an image on its background; further channels as ResizeArea.
ImageF ResizeRgbLikePillow(const ImageF& image, int width, int height);

}  // namespace oraclegs
