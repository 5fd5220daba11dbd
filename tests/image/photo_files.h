#pragma once
// HEIC, WebP, TIFF and EXIF that the image tests make.

#include <gtest/gtest.h>
#include <libheif/heif.h>
#include <tiffio.h>
#include <webp/encode.h>
#if defined(__SANITIZE_ADDRESS__)
#define ORACLEGS_CHECKS_LEAKS
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ORACLEGS_CHECKS_LEAKS
#endif
#endif
#ifdef ORACLEGS_CHECKS_LEAKS
#include <sanitizer/lsan_interface.h>
#endif

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/image.h"

namespace oraclegs {

/// Numbers of an EXIF block, little-endian.
class ExifMaker {
 public:
  static std::string Number(uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i & 255);
    return text;
  }

  void Short(unsigned tag, unsigned value) { Add(tag, 3, 1, Number(value, 2)); }
  void Long(unsigned tag, unsigned value) { Add(tag, 4, 1, Number(value, 4)); }
  void Text(unsigned tag, const std::string& text) { Add(tag, 2, text.size() + 1, text + '\0'); }
  void Rationals(unsigned tag, const std::vector<std::pair<unsigned, unsigned>>& values) {
    std::string bytes;
    for (const auto& [up, down] : values) bytes += Number(up, 4) + Number(down, 4);
    Add(tag, 5, values.size(), bytes);
  }
  void Sub(unsigned tag, const ExifMaker& directory) { subs_.emplace_back(tag, directory); }

  std::string Tiff() const { return "II" + Number(42, 2) + Number(8, 4) + Directory(8); }

 private:
  struct Entry {
    unsigned tag, type;
    size_t count;
    std::string bytes;
  };

  void Add(unsigned tag, unsigned type, size_t count, const std::string& bytes) {
    entries_.push_back({tag, type, count, bytes});
  }

  /// The directory for position `at`, followed by its long values and its subdirectories.
  std::string Directory(size_t at) const {
    const size_t entries = entries_.size() + subs_.size();
    size_t next = at + 2 + 12 * entries + 4;
    std::string head = Number(entries, 2), tail;
    for (const Entry& e : entries_) {
      head += Number(e.tag, 2) + Number(e.type, 2) + Number(e.count, 4);
      if (e.bytes.size() <= 4) {
        head += e.bytes + std::string(4 - e.bytes.size(), '\0');
      } else {
        head += Number(next + tail.size(), 4);
        tail += e.bytes;
      }
    }
    for (const auto& [tag, directory] : subs_) {
      head += Number(tag, 2) + Number(4, 2) + Number(1, 4) + Number(next + tail.size(), 4);
      tail += directory.Directory(next + tail.size());
    }
    return head + Number(0, 4) + tail;
  }

  std::vector<Entry> entries_;
  std::vector<std::pair<unsigned, ExifMaker>> subs_;
};

/// EXIF as a phone writes it: 26 mm on 36 mm film, 4000 x 3000 pixels.
inline std::string PhoneExif(unsigned orientation = 1) {
  ExifMaker exif, details, gps;
  exif.Text(0x010F, "Maker");
  exif.Text(0x0110, "Phone 9");
  exif.Short(0x0112, orientation);
  details.Text(0x9003, "2026:11:23 10:00:00");
  details.Rationals(0x920A, {{51, 10}});
  details.Long(0xA002, 4000);
  details.Long(0xA003, 3000);
  details.Short(0xA405, 26);
  gps.Text(1, "N");
  gps.Rationals(2, {{47, 1}, {30, 1}, {36, 1}});
  gps.Text(3, "W");
  gps.Rationals(4, {{8, 1}, {15, 1}, {0, 1}});
  gps.Rationals(6, {{4105, 10}});
  exif.Sub(0x8769, details);
  exif.Sub(0x8825, gps);
  return exif.Tiff();
}

inline std::string ExifSegmentOf(const std::string& tiff) {
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  const size_t length = body.size() + 2;
  return std::string("\xFF\xE1") + static_cast<char>(length >> 8) + static_cast<char>(length & 255) + body;
}

inline std::string WithExif(const std::string& jpeg, const std::string& tiff) {
  return jpeg.substr(0, 2) + ExifSegmentOf(tiff) + jpeg.substr(2);
}

/// Turns the leak check off in a scope: x265 never frees the tables of its first encoder.
struct UncheckedForLeaks {
#ifdef ORACLEGS_CHECKS_LEAKS
  UncheckedForLeaks() { __lsan_disable(); }
  ~UncheckedForLeaks() { __lsan_enable(); }
#else
  UncheckedForLeaks() {}  // NOLINT: it is used
#endif
};

/// A HEIC (or AVIF) of high quality, with an EXIF block unless `tiff` is empty. Empty when libheif cannot encode.
inline std::string EncodeHeif(const Image8& image, const std::string& tiff = "",
                              heif_compression_format format = heif_compression_HEVC) {
  const UncheckedForLeaks unchecked;
  heif_context* context = heif_context_alloc();
  heif_encoder* encoder = nullptr;
  std::string bytes;
  if (heif_context_get_encoder_for_format(context, format, &encoder).code == heif_error_Ok) {
    heif_encoder_set_lossy_quality(encoder, 95);
    heif_image* pixels = nullptr;
    const bool alpha = image.channels == 4;
    heif_image_create(image.width, image.height, heif_colorspace_RGB,
                      alpha ? heif_chroma_interleaved_RGBA : heif_chroma_interleaved_RGB, &pixels);
    heif_image_add_plane(pixels, heif_channel_interleaved, image.width, image.height, 8);
    int stride = 0;
    uint8_t* rows = heif_image_get_plane(pixels, heif_channel_interleaved, &stride);
    const size_t row = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
    for (int y = 0; y < image.height; ++y) std::memcpy(rows + y * stride, image.data.data() + y * row, row);
    heif_image_handle* handle = nullptr;
    EXPECT_EQ(heif_context_encode_image(context, pixels, encoder, nullptr, &handle).code, heif_error_Ok);
    if (!tiff.empty()) {
      const std::string block = std::string("Exif\0\0", 6) + tiff;
      EXPECT_EQ(heif_context_add_exif_metadata(context, handle, block.data(), static_cast<int>(block.size())).code,
                heif_error_Ok);
    }
    heif_writer writer{1, [](heif_context*, const void* data, size_t size, void* target) {
                         static_cast<std::string*>(target)->assign(static_cast<const char*>(data), size);
                         return heif_error{heif_error_Ok, heif_suberror_Unspecified, ""};
                       }};
    heif_context_write(context, &writer, &bytes);
    heif_image_handle_release(handle);
    heif_image_release(pixels);
    heif_encoder_release(encoder);
  }
  heif_context_free(context);
  return bytes;
}

/// Lossless, with an EXIF chunk unless `tiff` is empty.
inline std::string EncodeWebp(const Image8& image, const std::string& tiff = "") {
  uint8_t* data = nullptr;
  const int stride = image.width * image.channels;
  const size_t size = image.channels == 4
                          ? WebPEncodeLosslessRGBA(image.data.data(), image.width, image.height, stride, &data)
                          : WebPEncodeLosslessRGB(image.data.data(), image.width, image.height, stride, &data);
  std::string bytes(reinterpret_cast<char*>(data), size);
  WebPFree(data);
  if (tiff.empty()) return bytes;
  const auto number = ExifMaker::Number;
  const auto w = static_cast<uint64_t>(image.width - 1), h = static_cast<uint64_t>(image.height - 1);
  const std::string padded = tiff.size() % 2 == 0 ? tiff : tiff + '\0';
  const std::string body = "WEBPVP8X" + number(10, 4) + number(0x08 | (image.channels == 4 ? 0x10 : 0), 4) +
                           number(w, 3) + number(h, 3) + bytes.substr(12) + "EXIF" + number(tiff.size(), 4) + padded;
  return "RIFF" + number(body.size(), 4) + body;
}

struct TiffLayout {
  int bits = 8;
  uint16_t orientation = 1;
  uint16_t compression = COMPRESSION_ADOBE_DEFLATE;
};

/// RGB or RGBA (straight alpha).
inline std::string EncodeTiff(const std::filesystem::path& path, const Image8& image, const TiffLayout& layout = {}) {
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, image.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, image.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, layout.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, image.channels);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout.compression);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, layout.orientation);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 8);
  const uint16_t extra = EXTRASAMPLE_UNASSALPHA;
  if (image.channels == 4) TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &extra);
  const size_t row = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels);
  for (int y = 0; y < image.height; ++y) {
    std::vector<uint8_t> bytes(image.data.begin() + y * row, image.data.begin() + (y + 1) * row);
    std::vector<uint16_t> wide;
    for (const uint8_t value : bytes) wide.push_back(static_cast<uint16_t>(value * 257));
    TIFFWriteScanline(tiff, layout.bits == 16 ? static_cast<void*>(wide.data()) : bytes.data(),
                      static_cast<uint32_t>(y), 0);
  }
  TIFFClose(tiff);
  return ReadFile(path);
}

/// Gives every prefix of `bytes` and many damaged copies to `decode`, which may only return or throw InputError.
template <class Decode>
void DecodeDamaged(const std::string& bytes, const Decode& decode) {
  const auto attempt = [&](const std::string& damaged) {
    try {
      decode(damaged);
    } catch (const InputError&) {
    }
  };
  for (size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 200) attempt(bytes.substr(0, length));
  uint32_t state = 1;
  for (int i = 0; i < 300; ++i) {
    std::string damaged = bytes;
    for (int flips = 0; flips <= i % 4; ++flips) {
      state = state * 1664525u + 1013904223u;
      const size_t within = i % 2 == 0 ? bytes.size() : std::min<size_t>(bytes.size(), 400);  // headers are small
      damaged[(state >> 8) % within] ^= static_cast<char>(1 << (state >> 28) % 8);
    }
    attempt(damaged);
  }
}

}  // namespace oraclegs
