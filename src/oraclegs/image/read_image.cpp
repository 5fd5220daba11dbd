#include "oraclegs/image/read_image.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/jpeg.h"
#include "oraclegs/image/png.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 31;  // an image of the largest size without compression

[[noreturn]] void RefuseFormat(const std::string& bytes, const std::string& file) {
  if (bytes.empty()) throw InputError("{}: is empty; copy the image again", file);
  throw InputError("{}: is not a JPEG or PNG image, whatever its name says; convert it to one", file);
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

}  // namespace oraclegs
