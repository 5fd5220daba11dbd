#pragma once
// JPEGs that the image tests make.

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <cmath>
#include <string>
#include <vector>

#include "oraclegs/image/image.h"

namespace oraclegs {

struct JpegLayout {
  int pixel_format = TJPF_RGB;
  int subsampling = TJSAMP_444;
  int flags = 0;
};

/// Quality 100.
inline std::string EncodeJpeg(const Image8& image, const JpegLayout& layout = {}) {
  tjhandle encoder = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(tjCompress2(encoder, image.data.data(), image.width, 0, image.height, layout.pixel_format, &bytes, &size,
                        layout.subsampling, 100, layout.flags),
            0)
      << tjGetErrorStr2(encoder);
  std::string jpeg(reinterpret_cast<char*>(bytes), size);
  tjFree(bytes);
  tjDestroy(encoder);
  return jpeg;
}

/// An APP1 segment of one entry: the orientation.
inline std::string ExifSegment(int orientation, bool big_endian) {
  const auto number = [big_endian](unsigned value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) {
      text += static_cast<char>(value >> 8 * (big_endian ? bytes - 1 - i : i) & 255);
    }
    return text;
  };
  const std::string tiff = (big_endian ? "MM" : "II") + number(42, 2) + number(8, 4) + number(1, 2) +
                           number(0x0112, 2) + number(3, 2) + number(1, 4) +
                           number(static_cast<unsigned>(orientation), 2) + number(0, 2) + number(0, 4);
  const std::string body = std::string("Exif\0\0", 6) + tiff;
  const size_t length = body.size() + 2;
  return std::string("\xFF\xE1") + static_cast<char>(length >> 8) + static_cast<char>(length & 255) + body;
}

inline std::string WithOrientation(const std::string& jpeg, int orientation) {
  return jpeg.substr(0, 2) + ExifSegment(orientation, false) + jpeg.substr(2);
}

/// A smooth image, which JPEG keeps to a few steps of 255.
inline Image8 SmoothImage(int width, int height, int channels) {
  Image8 image{width, height, channels, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const double wave = std::sin(0.05 * x * (c + 1) + 0.03 * y) + std::cos(0.04 * y * (c + 1));
        image.data.push_back(static_cast<uint8_t>(128 + 55 * wave));
      }
    }
  }
  return image;
}

}  // namespace oraclegs
