#include "oraclegs/image/exif.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

#include "oraclegs/image/codecs.h"

namespace oraclegs {
namespace {

constexpr size_t kEntryBytes = 12;     // tag 2, type 2, count 4, value or offset 4
constexpr unsigned kMaxEntries = 512;  // of one directory; cameras write some fifty
constexpr size_t kMaxText = 64;
constexpr double kDiagonal35mm = 43.2666;  // millimeters: focal lengths of "35 mm film" compare diagonals
constexpr std::string_view kExifHead("Exif\0\0", 6);

enum Tag : unsigned {
  kMake = 0x010F,
  kModel = 0x0110,
  kOrientation = 0x0112,
  kExifDirectory = 0x8769,
  kGpsDirectory = 0x8825,
  kDateTaken = 0x9003,
  kFocalLength = 0x920A,
  kPixelWidth = 0xA002,
  kPixelHeight = 0xA003,
  kPlaneXResolution = 0xA20E,
  kPlaneUnit = 0xA210,
  kFocalLength35 = 0xA405,
};
enum GpsTag : unsigned { kLatitudeRef = 1, kLatitude, kLongitudeRef, kLongitude, kAltitudeRef, kAltitude };

uint64_t NumberAt(std::string_view bytes, size_t at, size_t count, bool big_endian) {
  uint64_t value = 0;
  for (size_t i = 0; i < count; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + (big_endian ? i : count - 1 - i)]);
  }
  return value;
}

/// A number; nothing where it would reach beyond the bytes.
std::optional<uint64_t> Number(std::string_view bytes, uint64_t at, size_t count, bool big_endian) {
  if (at > bytes.size() || bytes.size() - at < count) return std::nullopt;
  return NumberAt(bytes, static_cast<size_t>(at), count, big_endian);
}

/// One directory of a TIFF structure: its entries by tag.
class Directory {
 public:
  Directory(std::string_view tiff, bool big_endian, uint64_t at) : tiff_(tiff), big_endian_(big_endian), at_(at) {
    entries_ = static_cast<unsigned>(std::min<uint64_t>(U(at, 2).value_or(0), kMaxEntries));
  }

  /// Element `index` of an entry as a number, also of a rational; nothing when it is missing, damaged or not finite.
  std::optional<double> Value(unsigned tag, unsigned index = 0) const {
    const auto entry = Find(tag);
    if (!entry || index >= entry->count) return std::nullopt;
    const uint64_t at = entry->at + uint64_t{index} * entry->size;
    switch (entry->type) {
      case 5:     // unsigned rational
      case 10: {  // signed rational
        const auto up = U(at, 4), down = U(at + 4, 4);
        if (!up || !down || *down == 0) return std::nullopt;
        if (entry->type == 5) return static_cast<double>(*up) / static_cast<double>(*down);
        return static_cast<double>(static_cast<int32_t>(*up)) / static_cast<int32_t>(*down);
      }
      case 1:
      case 3:
      case 4: {
        const auto value = U(at, entry->size);
        return value ? std::optional<double>(static_cast<double>(*value)) : std::nullopt;
      }
      default:
        return std::nullopt;
    }
  }

  /// Where the directory begins that a tag names; a number below zero is no place.
  std::optional<uint64_t> PlaceOf(unsigned tag) const {
    const auto value = Value(tag);
    return value && *value >= 0 ? std::optional(static_cast<uint64_t>(*value)) : std::nullopt;
  }

  std::string Text(unsigned tag) const {
    const auto entry = Find(tag);
    if (!entry || entry->type != 2 || entry->at >= tiff_.size()) return "";
    std::string_view text = tiff_.substr(static_cast<size_t>(entry->at), std::min<size_t>(entry->count, kMaxText));
    text = text.substr(0, text.find('\0'));
    std::string out;
    for (const char c : text) out += c >= ' ' && c <= '~' ? c : ' ';
    const size_t begin = out.find_first_not_of(' '), end = out.find_last_not_of(' ');
    return begin == std::string::npos ? "" : out.substr(begin, end - begin + 1);
  }

 private:
  struct Entry {
    unsigned type = 0, size = 0;  ///< bytes of one element
    uint64_t count = 0, at = 0;   ///< where the elements begin
  };

  std::optional<uint64_t> U(uint64_t at, size_t count) const { return Number(tiff_, at, count, big_endian_); }

  std::optional<Entry> Find(unsigned tag) const {
    static constexpr std::array<unsigned, 13> kSizes{0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8};
    for (unsigned i = 0; i < entries_; ++i) {
      const uint64_t at = at_ + 2 + i * kEntryBytes;
      if (U(at, 2) != std::optional<uint64_t>(tag)) continue;
      const auto type = U(at + 2, 2), count = U(at + 4, 4);
      if (!type || !count || *type == 0 || *type >= kSizes.size() || *count == 0) return std::nullopt;
      Entry entry{static_cast<unsigned>(*type), kSizes[static_cast<size_t>(*type)], *count, at + 8};
      if (entry.size * entry.count > 4) {
        const auto offset = U(at + 8, 4);
        if (!offset) return std::nullopt;
        entry.at = *offset;
      }
      return entry;
    }
    return std::nullopt;
  }

  std::string_view tiff_;
  bool big_endian_;
  uint64_t at_;
  unsigned entries_ = 0;
};

std::optional<double> Degrees(const Directory& gps, unsigned tag, unsigned reference, char negative) {
  const auto degrees = gps.Value(tag, 0);
  if (!degrees) return std::nullopt;
  const double value = *degrees + gps.Value(tag, 1).value_or(0) / 60 + gps.Value(tag, 2).value_or(0) / 3600;
  return gps.Text(reference).starts_with(negative) ? -value : value;
}

std::optional<GpsPosition> Position(const Directory& gps) {
  const auto latitude = Degrees(gps, kLatitude, kLatitudeRef, 'S');
  const auto longitude = Degrees(gps, kLongitude, kLongitudeRef, 'W');
  if (!latitude || !longitude || std::abs(*latitude) > 90 || std::abs(*longitude) > 180) return std::nullopt;
  GpsPosition position{*latitude, *longitude, gps.Value(kAltitude)};
  if (position.altitude && gps.Value(kAltitudeRef) == 1.0) position.altitude = -*position.altitude;
  return position;
}

double MillimetersOf(double unit) {
  if (unit == 3) return 10;
  return unit == 4 ? 1 : unit == 5 ? .001 : 25.4;
}

int Side(const Directory& directory, unsigned tag) {
  const double value = directory.Value(tag).value_or(0);
  return value >= 1 && value < 1e6 ? static_cast<int>(value) : 0;
}

std::string_view JpegBlock(std::string_view jpeg) {
  size_t at = 2;
  while (true) {
    while (Number(jpeg, at, 2, true) == std::optional<uint64_t>(0xFFFF)) ++at;  // fill bytes
    const auto marker = Number(jpeg, at, 2, true), length = Number(jpeg, at + 2, 2, true);
    if (!marker || *marker < 0xFF01 || *marker == 0xFFDA || *marker == 0xFFD9) return {};
    if (!length || *length < 2 || jpeg.size() - at - 2 < *length) return {};
    const std::string_view body = jpeg.substr(at + 4, static_cast<size_t>(*length) - 2);
    if (*marker == 0xFFE1 && body.starts_with(kExifHead)) return body.substr(kExifHead.size());
    at += 2 + static_cast<size_t>(*length);
  }
}

/// Chunks of a length and a name: PNG's (big-endian length first, checksum behind), or RIFF's (name first, padded).
std::string_view Chunk(std::string_view bytes, size_t at, std::string_view name, bool png) {
  while (const auto length = Number(bytes, at + (png ? 0 : 4), 4, png)) {
    if (bytes.size() - at < 8 || *length > bytes.size() - at - 8) return {};
    if (bytes.substr(at + (png ? 4 : 0), 4) == name) return bytes.substr(at + 8, static_cast<size_t>(*length));
    at += 8 + static_cast<size_t>(*length) + (png ? 4 : *length % 2);
    if (at >= bytes.size()) return {};
  }
  return {};
}

std::string_view WithoutMark(std::string_view block) {
  return block.starts_with(kExifHead) ? block.substr(kExifHead.size()) : block;
}

constexpr std::string_view kExifMark("Exif\0\0", 6);
constexpr std::string_view kAdobeMark = "Adobe";

/// The 16-bit number there; nothing beyond the end.
std::optional<unsigned> U16(std::string_view bytes, size_t at) {
  if (at > bytes.size() || bytes.size() - at < 2) return std::nullopt;
  return static_cast<unsigned>(static_cast<unsigned char>(bytes[at]) << 8 | static_cast<unsigned char>(bytes[at + 1]));
}

}  // namespace

Exif ParseExif(std::string_view tiff) {
  Exif exif;
  const bool big_endian = tiff.starts_with("MM");
  if (!big_endian && !tiff.starts_with("II")) return exif;
  const auto first = Number(tiff, 4, 4, big_endian);
  if (Number(tiff, 2, 2, big_endian) != std::optional<uint64_t>(42) || !first) return exif;
  const Directory main(tiff, big_endian, *first);
  const double orientation = main.Value(kOrientation).value_or(1);
  if (orientation >= 1 && orientation <= 8) exif.orientation = static_cast<int>(orientation);
  exif.make = main.Text(kMake);
  exif.model = main.Text(kModel);
  if (const auto at = main.PlaceOf(kExifDirectory)) {
    const Directory details(tiff, big_endian, *at);
    exif.date = details.Text(kDateTaken);
    exif.focal_mm = details.Value(kFocalLength).value_or(0);
    exif.focal_35mm = details.Value(kFocalLength35).value_or(0);
    exif.pixel_width = Side(details, kPixelWidth);
    exif.pixel_height = Side(details, kPixelHeight);
    const double per_unit = details.Value(kPlaneXResolution).value_or(0);
    if (per_unit > 0) exif.pixels_per_mm = per_unit / MillimetersOf(details.Value(kPlaneUnit).value_or(2));
  }
  if (const auto at = main.PlaceOf(kGpsDirectory)) {
    exif.gps = Position(Directory(tiff, big_endian, *at));
  }
  return exif;
}

Exif ReadExif(std::string_view file) {
  if (file.starts_with("\xFF\xD8")) return ParseExif(JpegBlock(file));
  if (file.starts_with("\x89PNG")) return ParseExif(Chunk(file, 8, "eXIf", /*png=*/true));
  if (file.starts_with("RIFF")) return ParseExif(WithoutMark(Chunk(file, 12, "EXIF", /*png=*/false)));
  if (file.starts_with("II") || file.starts_with("MM")) return ParseExif(file);
  if (IsHeif(file)) return ParseExif(ReadHeifExif(file));
  return {};
}

std::optional<double> FocalPixels(const Exif& exif, int width, int height) {
  const double diagonal = std::hypot(width, height);
  double focal = 0;
  if (exif.focal_35mm > 0) {
    focal = exif.focal_35mm / kDiagonal35mm * diagonal;
  } else if (exif.focal_mm > 0 && exif.pixels_per_mm > 0 && exif.pixel_width > 0 && exif.pixel_height > 0) {
    focal =
        exif.focal_mm * exif.pixels_per_mm * std::max(width, height) / std::max(exif.pixel_width, exif.pixel_height);
  }
  const double longest = std::max(width, height);
  const bool is_lens = std::isfinite(focal) && focal > longest * .134 && focal < longest * 14.3;
  return is_lens ? std::optional<double>(focal) : std::nullopt;
}

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
