#include "oraclegs/image/exif.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace oraclegs {
namespace {

constexpr std::string_view kExifMark("Exif\0\0", 6);
constexpr std::string_view kAdobeMark = "Adobe";
constexpr unsigned kOrientationTag = 0x0112;
constexpr unsigned kShort = 3;      // EXIF's name for 16-bit numbers
constexpr size_t kEntryBytes = 12;  // tag 2, type 2, count 4, value 4

/// Numbers of a byte string, with no value beyond its end.
class Reader {
 public:
  Reader(std::string_view bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  std::optional<unsigned> U16(size_t at) const { return Number(at, 2); }
  std::optional<unsigned> U32(size_t at) const { return Number(at, 4); }

 private:
  std::optional<unsigned> Number(size_t at, size_t count) const {
    if (at > bytes_.size() || bytes_.size() - at < count) return std::nullopt;
    unsigned value = 0;
    for (size_t i = 0; i < count; ++i) {
      value = value << 8 | static_cast<unsigned char>(bytes_[at + (big_endian_ ? i : count - 1 - i)]);
    }
    return value;
  }

  std::string_view bytes_;
  bool big_endian_;
};

/// The orientation in the first directory of a TIFF structure.
std::optional<int> TiffOrientation(std::string_view tiff) {
  if (!tiff.starts_with("II") && !tiff.starts_with("MM")) return std::nullopt;
  const Reader reader(tiff, tiff.starts_with("MM"));
  const auto directory = reader.U32(4);
  if (reader.U16(2) != 42u || !directory) return std::nullopt;
  const unsigned entries = reader.U16(*directory).value_or(0);
  for (unsigned i = 0; i < entries; ++i) {
    const size_t entry = size_t{*directory} + 2 + i * kEntryBytes;
    const auto tag = reader.U16(entry);
    if (!tag) return std::nullopt;
    if (*tag != kOrientationTag) continue;
    const auto value = reader.U16(entry + 8);
    if (reader.U16(entry + 2) != kShort || !value || *value < 1 || *value > 8) return std::nullopt;
    return static_cast<int>(*value);
  }
  return std::nullopt;
}

}  // namespace

JpegMetadata ReadJpegMetadata(std::string_view jpeg) {
  JpegMetadata metadata;
  bool has_exif = false;
  const Reader reader(jpeg, /*big_endian=*/true);
  size_t at = 2;
  while (true) {
    while (reader.U16(at) == 0xFFFFu) ++at;  // fill bytes
    const auto marker = reader.U16(at);
    const auto length = reader.U16(at + 2);
    const bool ends = !marker || *marker < 0xFF01 || *marker == 0xFFDA || *marker == 0xFFD9;
    if (ends || !length || *length < 2 || jpeg.size() - at - 2 < *length) return metadata;
    const std::string_view body = jpeg.substr(at + 4, *length - 2);
    if (*marker == 0xFFE1 && body.starts_with(kExifMark) && !has_exif) {
      has_exif = true;
      metadata.orientation = TiffOrientation(body.substr(kExifMark.size())).value_or(1);
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
