#include "oraclegs/output/report/report_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr int kLargestSide = 960;  // pixels, of an image that fills a page
constexpr int kThumbnailSide = 200;
constexpr int kImageQuality = 85;  // JPEG; looks like quality 95 at half the size
constexpr int kThumbnailQuality = 75;

Image8 Reduced(const Image8& image, int largest) {
  const int side = std::max(image.width, image.height);
  if (side <= largest) return image;
  const auto scaled = [&](int length) {
    return std::max(1, static_cast<int>(std::lround(1.0 * length * largest / side)));
  };
  return ToImage8(ResizeArea(ToFloat(image), scaled(image.width), scaled(image.height)));
}

std::string Base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t three = 0;
    for (size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

const char* TypeOf(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".jpg") return "image/jpeg";
  if (extension == ".png") return "image/png";
  if (extension == ".mp4") return "video/mp4";
  return "application/octet-stream";
}

}  // namespace

nlohmann::json ReportFiles::Bytes(const std::string& name, std::string_view bytes) const {
  const std::string url = "report/" + name;
  WriteFileAtomically(root_ / url, bytes);
  return {{"url", url}};
}

nlohmann::json ReportFiles::Image(const std::string& name, const Image8& image) const {
  return Bytes("images/" + name + ".jpg", CompressJpeg(Reduced(image, kLargestSide), kImageQuality));
}

nlohmann::json ReportFiles::Thumbnail(const std::string& name, const Image8& image) const {
  return Bytes("images/" + name + ".jpg", CompressJpeg(Reduced(image, kThumbnailSide), kThumbnailQuality));
}

nlohmann::json WithFilesInside(const nlohmann::json& document, const fs::path& root) {
  nlohmann::json inside = document;
  if (inside.is_object() && inside.contains("url") && inside["url"].is_string()) {
    const fs::path file = root / inside["url"].get<std::string>();
    inside["url"] = fmt::format("data:{};base64,{}", TypeOf(file), Base64(ReadFile(file)));
  }
  if (inside.is_structured()) {
    for (nlohmann::json& part : inside) part = WithFilesInside(part, root);
  }
  return inside;
}

}  // namespace oraclegs
