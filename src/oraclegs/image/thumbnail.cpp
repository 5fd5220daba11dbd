#include "oraclegs/image/thumbnail.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/files.h"
#include "oraclegs/image/jpeg.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxThumbnailFile = uint64_t{1} << 31;

Image8 ToGray(const Image8& image) {
  if (image.channels == 1) return image;
  Image8 gray{image.width, image.height, 1, std::vector<uint8_t>(image.data.size() / image.channels)};
  for (size_t i = 0; i < gray.data.size(); ++i) {
    const uint8_t* pixel = image.data.data() + i * static_cast<size_t>(image.channels);
    gray.data[i] = static_cast<uint8_t>((77 * pixel[0] + 150 * pixel[1] + 29 * pixel[2]) >> 8);
  }
  return gray;
}

}  // namespace

Image8 ReadGrayThumbnail(const std::filesystem::path& path, int max_side) {
  const std::string bytes = ReadFile(path, kMaxThumbnailFile);
  Image8 gray = IsJpeg(bytes) ? DecodeReducedJpeg(bytes, path.string(), max_side)
                              : ToGray(ReadImage(path, Orientation::kAsStored));
  const int longest = std::max(gray.width, gray.height);
  if (longest <= max_side) return gray;
  const double scale = static_cast<double>(max_side) / longest;
  return ToImage8(ResizeArea(ToFloat(gray), std::max(1, static_cast<int>(std::lround(gray.width * scale))),
                             std::max(1, static_cast<int>(std::lround(gray.height * scale)))));
}

}  // namespace oraclegs
