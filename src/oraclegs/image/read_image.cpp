#include "oraclegs/image/read_image.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/function_ref.h"
#include "oraclegs/image/codecs.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 31;  // an image of the largest size without compression

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

/// Calls `read` with the beginning of a file where that `suffices`, and with all of it where it does not or is found
/// damaged.
void ReadBeginning(const std::filesystem::path& path, FunctionRef<bool(const std::string&)> suffices,
                   FunctionRef<void(const std::string&)> read) {
  for (const size_t bytes : kHeads) {
    const std::string head = ReadHead(path, bytes);
    if (!suffices(head)) break;
    try {
      return read(head);
    } catch (const InputError&) {  // what the head alone does not say, or hold
    }
    if (head.size() < bytes) break;
  }
  read(ReadFile(path, kMaxFileBytes));
}

const char* ExtensionOf(const std::string& bytes) {
  if (IsJpeg(bytes)) return ".jpg";
  if (IsPng(bytes)) return ".png";
  if (IsHeif(bytes)) return ".heic";
  return IsWebp(bytes) ? ".webp" : ".tif";
}

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

Image8 ReadImage(const std::filesystem::path& path, Orientation orientation) {
  const std::string bytes = ReadFile(path, kMaxFileBytes);
  if (IsJpeg(bytes)) return DecodeJpeg(bytes, path.string(), orientation);
  if (IsPng(bytes)) return DecodePng(bytes, path.string());
  if (IsHeif(bytes)) return DecodeHeif(bytes, path.string());
  if (IsWebp(bytes)) return DecodeWebp(bytes, path.string(), orientation);
  if (IsTiff(bytes)) return DecodeTiff(bytes, path.string(), orientation);
  RefuseFormat(bytes, path.string());
}

void ReadImageSize(const std::filesystem::path& path, int* width, int* height, Orientation orientation) {
  const bool wants_exif = orientation == Orientation::kUpright;
  const auto suffices = [&](const std::string& head) {
    return IsImage(head) && !(IsWebp(head) && wants_exif);  // a WebP ends with its EXIF
  };
  ReadBeginning(path, suffices,
                [&](const std::string& bytes) { SizeOf(bytes, path.string(), orientation, width, height); });
}

ImageInfo ReadImageInfo(const std::filesystem::path& path) {
  ImageInfo info;
  const auto is_jpeg = [](const std::string& head) { return IsJpeg(head); };  // others may end with their EXIF
  ReadBeginning(path, is_jpeg, [&](const std::string& bytes) {
    SizeOf(bytes, path.string(), Orientation::kUpright, &info.width, &info.height);
    info.exif = ReadExif(bytes);
    info.extension = ExtensionOf(bytes);
  });
  return info;
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
