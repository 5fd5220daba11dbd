#include "oraclegs/image/codecs.h"

#include <turbojpeg.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"
#include "oraclegs/image/exif.h"

namespace oraclegs {
namespace {

// A progressive scan can skip 32767 blocks with two bytes, but the first scan spends at least a bit on each block.
constexpr uint64_t kJpegPixelsPerByte = 1024;

struct CloseCodec {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Decoder = std::unique_ptr<void, CloseCodec>;

struct Header {
  int width = 0, height = 0, subsampling = 0, colors = 0;
};

const unsigned char* Data(std::string_view bytes) { return reinterpret_cast<const unsigned char*>(bytes.data()); }

Decoder MakeDecoder() {
  Decoder decoder(tjInitDecompress());
  if (!decoder) throw RunError("the JPEG decoder cannot start: {}", tjGetErrorStr2(nullptr));
  return decoder;
}

Header ReadHeader(const Decoder& decoder, std::string_view bytes, const std::string& file) {
  Header header;
  if (tjDecompressHeader3(decoder.get(), Data(bytes), bytes.size(), &header.width, &header.height, &header.subsampling,
                          &header.colors) != 0 &&
      tjGetErrorCode(decoder.get()) != TJERR_WARNING) {
    throw InputError("{}: is a damaged JPEG ({}); copy or export it again", file,
                     OneLine(tjGetErrorStr2(decoder.get())));
  }
  CheckImageSize(header.width, header.height, bytes.size() * kJpegPixelsPerByte, file);
  return header;
}

/// libjpeg goes on after damage and paints the rest gray; only oddities that leave the image whole may pass.
bool IsHarmless(std::string_view warning) {
  const auto says = [warning](std::string_view words) { return warning.find(words) != std::string_view::npos; };
  return says("extraneous bytes") || !(says("Corrupt JPEG") || says("Premature end"));
}

/// Inks to light: Adobe's programs store 255 for no ink, the format itself says 0.
Image8 CmykToRgb(const std::vector<uint8_t>& cmyk, const Header& header, bool inverted) {
  Image8 rgb{header.width, header.height, 3, std::vector<uint8_t>(cmyk.size() / 4 * 3)};
  for (size_t i = 0; i < cmyk.size() / 4; ++i) {
    const auto light = [&](size_t channel) {
      const int stored = cmyk[4 * i + channel];
      return inverted ? stored : 255 - stored;
    };
    for (size_t c = 0; c < 3; ++c) rgb.data[3 * i + c] = static_cast<uint8_t>((light(c) * light(3) + 127) / 255);
  }
  return rgb;
}

}  // namespace

bool IsJpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8\xFF"); }

Image8 DecodeJpeg(std::string_view bytes, const std::string& file, Orientation orientation) {
  const Decoder decoder = MakeDecoder();
  const Header header = ReadHeader(decoder, bytes, file);
  const JpegMetadata metadata = ReadJpegMetadata(bytes);
  const bool is_cmyk = header.colors == TJCS_CMYK || header.colors == TJCS_YCCK;
  const int channels = is_cmyk ? 4 : 3;
  Image8 image{header.width, header.height, 3, {}};
  image.data.resize(static_cast<size_t>(header.width) * static_cast<size_t>(header.height) *
                    static_cast<size_t>(channels));
  // Many scans in a small file take minutes to decode and make no image that a camera writes.
  const int result = tjDecompress2(decoder.get(), Data(bytes), bytes.size(), image.data.data(), header.width, 0,
                                   header.height, is_cmyk ? TJPF_CMYK : TJPF_RGB, TJFLAG_LIMITSCANS);
  if (result != 0) {
    const std::string message = OneLine(tjGetErrorStr2(decoder.get()));
    if (tjGetErrorCode(decoder.get()) != TJERR_WARNING || !IsHarmless(message)) {
      throw InputError("{}: is a damaged or incomplete JPEG ({}); copy or export it again", file, message);
    }
  }
  if (is_cmyk) image = CmykToRgb(image.data, header, metadata.has_adobe_mark);
  return ApplyOrientation(std::move(image), orientation == Orientation::kUpright ? metadata.orientation : 1);
}

Image8 DecodeReducedJpeg(std::string_view bytes, const std::string& file, int min_side) {
  const Decoder decoder = MakeDecoder();
  const Header header = ReadHeader(decoder, bytes, file);
  Image8 image{header.width, header.height, 1, {}};
  for (int denominator = 8; denominator > 1; denominator /= 2) {
    const tjscalingfactor factor{1, denominator};
    if (std::max(TJSCALED(header.width, factor), TJSCALED(header.height, factor)) < min_side) continue;
    image.width = TJSCALED(header.width, factor);
    image.height = TJSCALED(header.height, factor);
    break;
  }
  const bool is_cmyk = header.colors == TJCS_CMYK || header.colors == TJCS_YCCK;
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  image.data.resize(pixels * (is_cmyk ? 4 : 1));
  const int result = tjDecompress2(decoder.get(), Data(bytes), bytes.size(), image.data.data(), image.width, 0,
                                   image.height, is_cmyk ? TJPF_CMYK : TJPF_GRAY, TJFLAG_LIMITSCANS | TJFLAG_FASTDCT);
  if (result != 0) {
    const std::string message = OneLine(tjGetErrorStr2(decoder.get()));
    if (tjGetErrorCode(decoder.get()) != TJERR_WARNING || !IsHarmless(message)) {
      throw InputError("{}: is a damaged or incomplete JPEG ({}); copy or export it again", file, message);
    }
  }
  if (is_cmyk) {  // the green of what is seen is near its gray
    const Header reduced{image.width, image.height, header.subsampling, header.colors};
    const Image8 rgb = CmykToRgb(image.data, reduced, ReadJpegMetadata(bytes).has_adobe_mark);
    image.data.resize(pixels);
    for (size_t i = 0; i < pixels; ++i) image.data[i] = rgb.data[3 * i + 1];
  }
  return image;
}

void ReadJpegSize(std::string_view bytes, const std::string& file, Orientation orientation, int* width, int* height) {
  const Decoder decoder = MakeDecoder();
  const Header header = ReadHeader(decoder, bytes, file);
  *width = header.width;
  *height = header.height;
  if (orientation == Orientation::kUpright && SwapsAxes(ReadJpegMetadata(bytes).orientation))
    std::swap(*width, *height);
}

std::string CompressJpeg(const Image8& image, int quality) {
  const std::unique_ptr<void, CloseCodec> encoder(tjInitCompress());
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const bool gray = image.channels == 1;
  if (!encoder ||
      tjCompress2(encoder.get(), image.data.data(), image.width, 0, image.height, gray ? TJPF_GRAY : TJPF_RGB, &bytes,
                  &size, gray ? TJSAMP_GRAY : TJSAMP_420, quality, 0) != 0) {
    const std::string why = OneLine(tjGetErrorStr2(encoder.get()));
    tjFree(bytes);
    throw RunError("an image of {} x {} pixels cannot be written as JPEG: {}", image.width, image.height, why);
  }
  std::string jpeg(reinterpret_cast<const char*>(bytes), size);
  tjFree(bytes);
  return jpeg;
}

}  // namespace oraclegs
