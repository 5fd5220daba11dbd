#pragma once
// Scenes of a few pixels that the readers' tests write.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/image/codecs.h"
#include "support/temp_dir.h"

namespace oraclegs {

inline void WriteImage(const std::filesystem::path& path, int width = 6, int height = 4) {
  std::filesystem::create_directories(path.parent_path());
  WritePng(path, {width, height, 3, std::vector<uint8_t>(static_cast<size_t>(width * height * 3), 100)});
}

/// Appends numbers in the binary form of a .bin file.
class Bytes {
 public:
  template <class T>
  Bytes& Add(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
    return *this;
  }
  Bytes& Add(std::initializer_list<double> values) {
    for (const double v : values) Add<double>(v);
    return *this;
  }
  Bytes& AddName(const std::string& name) {
    bytes_.append(name.c_str(), name.size() + 1);
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
};

/// One OPENCV and one SIMPLE_PINHOLE camera, both 6x4.
inline std::string TinyCamerasBin() {
  Bytes b;
  b.Add<uint64_t>(2);
  b.Add<uint32_t>(1).Add<int32_t>(4).Add<uint64_t>(6).Add<uint64_t>(4).Add({5, 5.5, 3, 2, 0.1, -0.2, 0.01, 0.02});
  b.Add<uint32_t>(7).Add<int32_t>(0).Add<uint64_t>(6).Add<uint64_t>(4).Add({5, 3, 2});
  return b.str();
}

/// b.png (id 3, a quarter turn about z, two keypoints), a.png (id 9, a quaternion of length 2), c.png (id 4).
inline std::string TinyImagesBin() {
  Bytes b;
  const double h = std::sqrt(0.5);
  b.Add<uint64_t>(3);
  b.Add<uint32_t>(3).Add({h, 0, 0, h, 1, 2, 3}).Add<uint32_t>(1).AddName("b.png").Add<uint64_t>(2);
  for (int i = 0; i < 2; ++i) b.Add({1.5, 2.5}).Add<uint64_t>(0);
  b.Add<uint32_t>(9).Add({2, 0, 0, 0, 0, 0, 0.5}).Add<uint32_t>(7).AddName("a.png").Add<uint64_t>(0);
  b.Add<uint32_t>(4).Add({1, 0, 0, 0, -1, 0, 0}).Add<uint32_t>(7).AddName("c.png").Add<uint64_t>(0);
  return b.str();
}

/// A point seen by c, b, b; one that is not finite; one without a track.
inline std::string TinyPointsBin() {
  Bytes b;
  const auto point = [&](std::initializer_list<double> xyz, std::initializer_list<uint32_t> track) {
    b.Add<uint64_t>(11).Add(xyz).Add<uint8_t>(10).Add<uint8_t>(20).Add<uint8_t>(255).Add<double>(0.5);
    b.Add<uint64_t>(track.size());
    for (const uint32_t image : track) b.Add<uint32_t>(image).Add<uint32_t>(0);
  };
  b.Add<uint64_t>(3);
  point({1, 2, 3}, {4, 3, 3});
  point({std::nan(""), 2, 3}, {4, 3});
  point({4, 5, 6}, {});
  return b.str();
}

inline void WriteTinyModel(const std::filesystem::path& dir) {
  WriteText(dir / "cameras.bin", TinyCamerasBin());
  WriteText(dir / "images.bin", TinyImagesBin());
  WriteText(dir / "points3D.bin", TinyPointsBin());
}

}  // namespace oraclegs
