#include "oraclegs/formats/webp.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

constexpr int kWebpEffort = 6;  // of 0..9; the highest is ten times as slow for 2 % less

}  // namespace

std::string EncodeWebp(const ByteImage& image) {
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigInit(&config) || !WebPConfigLosslessPreset(&config, kWebpEffort) || !WebPPictureInit(&picture)) {
    throw RunError("libwebp: another version than the one that the program was built with");
  }
  config.exact = 1;
  picture.use_argb = 1;
  picture.width = image.width;
  picture.height = image.height;
  WebPMemoryWriter memory;
  WebPMemoryWriterInit(&memory);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &memory;
  const bool good =
      WebPPictureImportRGBA(&picture, image.rgba.data(), 4 * image.width) && WebPEncode(&config, &picture);
  const int error = picture.error_code;
  std::string bytes(reinterpret_cast<const char*>(memory.mem), memory.size);
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&memory);
  if (!good) throw RunError("libwebp: cannot encode {} x {} pixels (error {})", image.width, image.height, error);
  return bytes;
}

ByteImage DecodeWebp(std::string_view bytes, int64_t max_pixels, const std::string& name) {
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  ByteImage image;
  if (!WebPGetInfo(data, bytes.size(), &image.width, &image.height)) {
    throw InputError("{}: is not a WebP image; export the splat again", name);
  }
  const int64_t pixels = int64_t{image.width} * image.height;
  if (pixels > max_pixels) {
    throw InputError("{}: has {} x {} pixels, many more than the splat has Gaussians; export it again", name,
                     image.width, image.height);
  }
  image.rgba.resize(static_cast<size_t>(4 * pixels));
  if (WebPDecodeRGBAInto(data, bytes.size(), image.rgba.data(), image.rgba.size(), 4 * image.width) == nullptr) {
    throw InputError("{}: the image is damaged; copy or export the splat again", name);
  }
  return image;
}

}  // namespace oraclegs
