#include "oraclegs/gaussians/ply_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

struct BinaryOptions {
  bool big_endian = false;
  uint8_t list_length = 2;
};

/// Vertices of doubles after an element of fixed rows and one with a list.
std::string BinaryFile(const BinaryOptions& options) {
  std::string bytes = std::string("ply\nformat binary_") + (options.big_endian ? "big" : "little") +
                      "_endian 1.0\nelement edge 3\nproperty int a\nproperty uchar b\nelement face 1\n"
                      "property list uchar short v\nelement vertex 2\nproperty double x\nproperty double y\n"
                      "property uchar c\nend_header\n";
  bytes.append(15, '\7');
  bytes.push_back(static_cast<char>(options.list_length));
  bytes.append(4, '\1');
  for (const double value : {0.5, -1e10, 2.25, 3.0}) {
    char raw[8];
    std::memcpy(raw, &value, 8);
    if (options.big_endian) std::reverse(raw, raw + 8);
    bytes.append(raw, 8);
    if (value == -1e10) bytes.push_back('\xff');
  }
  return bytes + '\x05';
}

std::vector<float> Columns(const std::string& bytes, const std::vector<std::string>& names) {
  return ReadPlyColumns(bytes, ParsePlyHeader(bytes, "file.ply"), "vertex", names, "file.ply");
}

TEST(PlyReader, ReadsBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    const std::string bytes = BinaryFile({big_endian});
    EXPECT_THAT(Columns(bytes, {"c", "y", "x"}), ElementsAre(255, -1e10f, 0.5f, 5, 3, 2.25f));
    EXPECT_THAT(Columns(bytes, {}), ElementsAre());
  }
}

TEST(PlyReader, RefusesEveryPrefix) {
  const std::string ascii =
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int v\nelement vertex 2\nproperty float x\n"
      "property float y\nend_header\n2 7 7\n1.5 2\n3 4\n";
  EXPECT_THAT(Columns(ascii, {"x", "y"}), ElementsAre(1.5f, 2, 3, 4));
  for (const std::string& whole : {BinaryFile({false}), BinaryFile({true}), ascii}) {
    for (size_t length = 0; length < whole.size(); ++length) {
      if (whole.substr(length) == "\n") continue;  // only the last newline is missing: all the numbers are there
      EXPECT_THROW(Columns(whole.substr(0, length), {"x", "y"}), InputError) << length;
    }
  }
}

TEST(PlyReader, SkipsLists) {
  const std::string bytes =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty list int float before\nproperty float x\n"
      "property list uchar float after\nend_header\n3 1 2 3 10 0\n0 20 1 9\n";
  EXPECT_THAT(Columns(bytes, {"x"}), ElementsAre(10, 20));
  EXPECT_THROW(Columns(bytes, {"before"}), InputError);
}

TEST(PlyReader, RefusesImpossibleLengths) {
  EXPECT_THROW(Columns(BinaryFile({false, 255}), {"x"}), InputError);
  for (const char* length : {"-1", "99999999999", "nan", "x"}) {
    const std::string bytes =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty list int float l\nproperty float x\nend_header\n" +
        std::string(length) + " 1\n";
    EXPECT_THROW(Columns(bytes, {"x"}), InputError) << length;
  }
  // An element without properties takes no bytes, whatever its count.
  const std::string empty = "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000000000\nend_header\n";
  EXPECT_THROW(Columns(empty, {"x"}), InputError);
  EXPECT_THAT(Columns(empty, {}), ElementsAre());
}

TEST(PlyReader, SurvivesAnyChangedByte) {
  for (const bool big_endian : {false, true}) {
    const std::string good = BinaryFile({big_endian});
    for (size_t i = 0; i < good.size(); ++i) {
      for (const char c : {'\0', '\n', ' ', '9', '\xff'}) {
        std::string bad = good;
        bad[i] = c;
        try {
          Columns(bad, {"x", "y"});
        } catch (const InputError& e) {
          EXPECT_EQ(std::string(e.what()).rfind("file.ply: ", 0), 0u) << e.what();
        }
      }
    }
  }
}

}  // namespace
}  // namespace oraclegs
