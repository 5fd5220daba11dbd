#include "oraclegs/image/codecs.h"

#include <webp/decode.h>

#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/image/exif.h"

namespace oraclegs {
namespace {

constexpr uint64_t kWebpPixelsPerByte = uint64_t{1} << 28;  // one color: a lossless WebP of any size in 30 bytes

const uint8_t* WebpData(std::string_view bytes) { return reinterpret_cast<const uint8_t*>(bytes.data()); }

WebPBitstreamFeatures ReadWebpHeader(std::string_view bytes, const std::string& file) {
  WebPBitstreamFeatures header;
  if (WebPGetFeatures(WebpData(bytes), bytes.size(), &header) != VP8_STATUS_OK) {
    throw InputError("{}: is a damaged WebP (no header); copy or export it again", file);
  }
  if (header.has_animation != 0) throw InputError("{}: is an animated WebP; save single images as JPEG or PNG", file);
  CheckImageSize(header.width, header.height, bytes.size() * kWebpPixelsPerByte, file);
  return header;
}

int WebpOrientation(std::string_view bytes, Orientation orientation) {
  return orientation == Orientation::kUpright ? ReadExif(bytes).orientation : 1;
}

}  // namespace

bool IsWebp(std::string_view bytes) { return bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP"); }

Image8 DecodeWebp(std::string_view bytes, const std::string& file, Orientation orientation) {
  const WebPBitstreamFeatures header = ReadWebpHeader(bytes, file);
  Image8 image{header.width, header.height, header.has_alpha != 0 ? 4 : 3, {}};
  const size_t row_bytes = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
  image.data.resize(row_bytes * static_cast<size_t>(image.height));
  const auto decode = image.channels == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  if (decode(WebpData(bytes), bytes.size(), image.data.data(), image.data.size(), static_cast<int>(row_bytes)) ==
      nullptr) {
    throw InputError("{}: is a damaged or incomplete WebP; copy or export it again", file);
  }
  return ApplyOrientation(std::move(image), WebpOrientation(bytes, orientation));
}

void ReadWebpSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height) {
  const WebPBitstreamFeatures header = ReadWebpHeader(bytes, file);
  *width = header.width;
  *height = header.height;
  if (SwapsAxes(WebpOrientation(bytes, orientation))) std::swap(*width, *height);
}

}  // namespace oraclegs
