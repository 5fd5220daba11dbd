#include "oraclegs/image/read_image.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/file_facts.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"

namespace oraclegs {
namespace {

// The headers of most images are in the first of these, large EXIF blocks and color profiles of a JPEG in the second.
constexpr size_t kHeads[] = {size_t{64} << 10, size_t{1} << 20};

[[noreturn]] void RefuseFormat(const std::string& bytes, const std::string& file) {
  if (bytes.empty()) throw InputError("{}: is empty; copy the image again", file);
  throw InputError("{}: is not a JPEG, PNG, HEIC, AVIF, WebP or TIFF image, whatever its name says; convert it to JPEG",
                   file);
}

void SizeOf(const std::string& bytes, const std::string& file, Orientation orientation, int* width, int* height) {
  if (IsJpeg(bytes)) return ReadJpegSize(bytes, file, orientation, width, height);
  if (IsPng(bytes)) return ReadPngSize(bytes, file, width, height);
  if (IsHeif(bytes)) return ReadHeifSize(bytes, file, width, height);
  if (IsWebp(bytes)) return ReadWebpSize(bytes, file, orientation, width, height);
  if (IsTiff(bytes)) return ReadTiffSize(bytes, file, orientation, width, height);
  RefuseFormat(bytes, file);
}

const char* ExtensionOf(const std::string& bytes) {
  if (IsJpeg(bytes)) return ".jpg";
  if (IsPng(bytes)) return ".png";
  if (IsHeif(bytes)) return ".heic";
  return IsWebp(bytes) ? ".webp" : ".tif";
}

/// Header of an image file, and its EXIF where the part that was read has it.
struct Beginning {
  ImageHeader header;
  std::optional<Exif> exif;  ///< nullopt: it may stand in what was not read
};

Beginning Parse(const std::string& bytes, const std::string& file, bool is_all) {
  Beginning read;
  ImageHeader& header = read.header;
  SizeOf(bytes, file, Orientation::kUpright, &header.width, &header.height);
  SizeOf(bytes, file, Orientation::kAsStored, &header.stored_width, &header.stored_height);
  header.extension = ExtensionOf(bytes);
  header.may_be_transparent = PngMayBeTransparent(bytes);
  header.projection = ReadProjection(std::string_view(bytes).substr(0, kHeads[1]));
  if (IsJpeg(bytes) || is_all) read.exif = ReadExif(bytes);  // others may end with their EXIF
  header.is_turned = IsJpeg(bytes) && read.exif->orientation != 1;
  return read;
}

/// Reads all of a file where its first bytes do not suffice or are found damaged.
Beginning ReadBeginning(const std::filesystem::path& path) {
  for (const size_t bytes : kHeads) {
    const std::string head = ReadHead(path, bytes);
    if (!IsImage(head) || IsWebp(head)) break;  // a WebP is turned by what it ends with
    try {
      return Parse(head, path.string(), /*is_all=*/false);
    } catch (const InputError&) {  // what the head alone does not say, or hold
    }
    if (head.size() < bytes) break;
  }
  return Parse(ReadFile(path, kMaxImageBytes), path.string(), /*is_all=*/true);
}

Beginning BeginningOf(const std::filesystem::path& path) {
  static FileFacts<Beginning> known;
  return known.Of(path, [&] { return ReadBeginning(path); });
}

Image8 Decode(const std::string& bytes, const std::string& file, Orientation orientation) {
  if (IsJpeg(bytes)) return DecodeJpeg(bytes, file, orientation);
  if (IsPng(bytes)) return DecodePng(bytes, file);
  if (IsHeif(bytes)) return DecodeHeif(bytes, file);
  if (IsWebp(bytes)) return DecodeWebp(bytes, file, orientation);
  if (IsTiff(bytes)) return DecodeTiff(bytes, file, orientation);
  RefuseFormat(bytes, file);
}

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

Image8 ReadImage(const std::filesystem::path& path, Orientation orientation) {
  return Decode(ReadFile(path, kMaxImageBytes), path.string(), orientation);
}

void ReadImageSize(const std::filesystem::path& path, int* width, int* height, Orientation orientation) {
  const ImageHeader header = ReadImageHeader(path);
  const bool upright = orientation == Orientation::kUpright;
  *width = upright ? header.width : header.stored_width;
  *height = upright ? header.height : header.stored_height;
}

ImageHeader ReadImageHeader(const std::filesystem::path& path) { return BeginningOf(path).header; }

ImageInfo ReadImageInfo(const std::filesystem::path& path) {
  static FileFacts<Exif> known;
  const Beginning read = BeginningOf(path);
  const auto of_all = [&] { return ReadExif(ReadFile(path, kMaxImageBytes)); };
  return {read.header.width, read.header.height, read.exif ? *read.exif : known.Of(path, of_all),
          read.header.extension};
}

bool IsImage(std::string_view bytes) {
  return IsJpeg(bytes) || IsPng(bytes) || IsHeif(bytes) || IsWebp(bytes) || IsTiff(bytes);
}

bool HasImageExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static constexpr std::array<std::string_view, 13> kKnown = {
      ".jpg", ".jpeg", ".jpe", ".jfif", ".mpo", ".png", ".heic", ".heif", ".hif", ".avif", ".webp", ".tif", ".tiff"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

Image8 ReadGrayThumbnail(const std::filesystem::path& path, int max_side) {
  return GrayThumbnail(ReadFile(path, kMaxImageBytes), path.string(), max_side);
}

Image8 GrayThumbnail(const std::string& bytes, const std::string& file, int max_side) {
  Image8 gray =
      IsJpeg(bytes) ? DecodeReducedJpeg(bytes, file, max_side) : ToGray(Decode(bytes, file, Orientation::kAsStored));
  const int longest = std::max(gray.width, gray.height);
  if (longest <= max_side) return gray;
  const double scale = static_cast<double>(max_side) / longest;
  return ToImage8(ResizeArea(ToFloat(gray), std::max(1, static_cast<int>(std::lround(gray.width * scale))),
                             std::max(1, static_cast<int>(std::lround(gray.height * scale)))));
}

}  // namespace oraclegs
