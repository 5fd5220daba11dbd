#include "oraclegs/image/image.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/jpeg.h"
#include "oraclegs/image/png.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 31;  // a picture of the largest size without compression

[[noreturn]] void RefuseFormat(const std::string& bytes, const std::string& file) {
  if (bytes.empty()) throw InputError("{}: is empty; copy the picture again", file);
  throw InputError("{}: is not a JPEG or PNG picture, whatever its name says; convert it to one", file);
}

}  // namespace

Image8 ReadImage(const std::filesystem::path& path, Orientation orientation) {
  const std::string bytes = ReadFile(path, kMaxFileBytes);
  if (IsJpeg(bytes)) return DecodeJpeg(bytes, path.string(), orientation);
  if (IsPng(bytes)) return DecodePng(bytes, path.string());
  RefuseFormat(bytes, path.string());
}

void ReadImageSize(const std::filesystem::path& path, int* width, int* height, Orientation orientation) {
  const std::string bytes = ReadFile(path, kMaxFileBytes);
  if (IsJpeg(bytes)) return ReadJpegSize(bytes, path.string(), orientation, width, height);
  if (IsPng(bytes)) return ReadPngSize(bytes, path.string(), width, height);
  RefuseFormat(bytes, path.string());
}

bool HasImageExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

ImageF ToFloat(const Image8& image) {
  ImageF result{image.width, image.height, image.channels, std::vector<float>(image.data.size())};
  std::transform(image.data.begin(), image.data.end(), result.data.begin(),
                 [](uint8_t value) { return static_cast<float>(value) / 255; });
  return result;
}

Image8 ToImage8(const ImageF& image) {
  Image8 result{image.width, image.height, image.channels, std::vector<uint8_t>(image.data.size())};
  std::transform(image.data.begin(), image.data.end(), result.data.begin(), [](float value) {
    const float clamped = value > 0 ? std::min(value, 1.f) : 0.f;  // not a number becomes 0
    return static_cast<uint8_t>(255 * clamped + 0.5f);
  });
  return result;
}

}  // namespace oraclegs
