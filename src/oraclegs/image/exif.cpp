#include "oraclegs/image/exif.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "oraclegs/image/exif_tags.h"

namespace oraclegs {
namespace {

constexpr std::string_view kExifMark("Exif\0\0", 6);
constexpr std::string_view kAdobeMark = "Adobe";

/// The 16-bit number there; nothing beyond the end.
std::optional<unsigned> U16(std::string_view bytes, size_t at) {
  if (at > bytes.size() || bytes.size() - at < 2) return std::nullopt;
  return static_cast<unsigned>(static_cast<unsigned char>(bytes[at]) << 8 | static_cast<unsigned char>(bytes[at + 1]));
}

}  // namespace

JpegMetadata ReadJpegMetadata(std::string_view jpeg) {
  JpegMetadata metadata;
  bool has_exif = false;
  size_t at = 2;
  while (true) {
    while (U16(jpeg, at) == 0xFFFFu) ++at;  // fill bytes
    const auto marker = U16(jpeg, at);
    const auto length = U16(jpeg, at + 2);
    const bool ends = !marker || *marker < 0xFF01 || *marker == 0xFFDA || *marker == 0xFFD9;
    if (ends || !length || *length < 2 || jpeg.size() - at - 2 < *length) return metadata;
    const std::string_view body = jpeg.substr(at + 4, *length - 2);
    if (*marker == 0xFFE1 && body.starts_with(kExifMark) && !has_exif) {
      has_exif = true;
      metadata.orientation = ParseExif(body.substr(kExifMark.size())).orientation;
    }
    if (*marker == 0xFFEE && body.starts_with(kAdobeMark)) metadata.has_adobe_mark = true;
    at += 2 + *length;
  }
}

bool SwapsAxes(int orientation) { return orientation >= 5 && orientation <= 8; }

Image8 ApplyOrientation(Image8 image, int orientation) {
  if (orientation < 2 || orientation > 8) return image;
  const bool swap = SwapsAxes(orientation);
  // Where the stored image is read from the right or from the bottom.
  const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool from_bottom = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  Image8 upright{swap ? image.height : image.width, swap ? image.width : image.height, image.channels, {}};
  upright.data.resize(image.data.size());
  const size_t channels = static_cast<size_t>(image.channels);
  uint8_t* out = upright.data.data();
  for (int y = 0; y < upright.height; ++y) {
    for (int x = 0; x < upright.width; ++x, out += channels) {
      const int across = swap ? y : x, down = swap ? x : y;
      const int from_x = from_right ? image.width - 1 - across : across;
      const int from_y = from_bottom ? image.height - 1 - down : down;
      const size_t from = static_cast<size_t>(from_y) * static_cast<size_t>(image.width) + static_cast<size_t>(from_x);
      std::copy_n(image.data.data() + from * channels, channels, out);
    }
  }
  return upright;
}

}  // namespace oraclegs
