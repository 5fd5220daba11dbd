#include "oraclegs/gaussians/ply_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const char kHeader[] =
    "ply\r\nformat binary_little_endian 1.0\ncomment element vertex 9\n\nelement edge 3\nproperty int a\n"
    "property\tuchar  b\nelement face 1\nproperty list uchar short v\nelement vertex 18446744073709551615\n"
    "property float64 x\nproperty float32 y\nend_header\n";

std::string Error(const std::string& bytes) {
  try {
    ParsePlyHeader(bytes, "file.ply");
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), StartsWith("file.ply: "));
    return e.what();
  }
  return "no error";
}

TEST(PlyHeader, IsParsed) {
  const PlyHeader header = ParsePlyHeader(std::string(kHeader) + "body\n", "file.ply");
  EXPECT_EQ(header.format, PlyFormat::kLittleEndian);
  EXPECT_EQ(header.body, sizeof(kHeader) - 1);
  ASSERT_EQ(header.elements.size(), 3u);
  EXPECT_EQ(header.elements[0].count, 3u);
  EXPECT_EQ(header.elements[0].properties[1].type, PlyType::kUint8);
  EXPECT_TRUE(header.elements[1].properties[0].is_list);
  EXPECT_EQ(header.elements[1].properties[0].count_type, PlyType::kUint8);
  EXPECT_EQ(header.elements[1].properties[0].type, PlyType::kInt16);
  EXPECT_EQ(header.Find("vertex"), 2);
  EXPECT_EQ(header.Find("nothing"), -1);
  EXPECT_EQ(header.elements[2].count, ~uint64_t{0});
  EXPECT_EQ(header.elements[2].Find("y"), 1);
  EXPECT_EQ(header.elements[2].Find("z"), -1);
}

TEST(PlyHeader, RefusesEveryPrefix) {
  const std::string whole = kHeader;
  for (size_t length = 0; length < whole.size(); ++length) EXPECT_NE(Error(whole.substr(0, length)), "no error");
  EXPECT_EQ(Error(whole), "no error");
}

TEST(PlyHeader, NamesTheUnknownLine) {
  EXPECT_THAT(Error("PLY\n"), HasSubstr("not a PLY"));
  EXPECT_THAT(Error("ply\nend_header\n"), HasSubstr("format"));
  EXPECT_THAT(Error("ply\nformat ascii 1.0\nformat ascii 1.0\nend_header\n"), HasSubstr("line 3"));
  for (const char* line :
       {"format middle_endian 1.0", "format ascii 1.1", "element vertex", "element vertex -1", "element vertex 1e3",
        "element vertex 18446744073709551616", "property float x", "nonsense"}) {
    EXPECT_THAT(Error(std::string("ply\n") + line + "\nend_header\n"), HasSubstr("line 2")) << line;
  }
  for (const char* line : {"element e 2", "property half x", "property float", "property float a b",
                           "property list float int a", "property list uchar a", "property int x"}) {
    const std::string head = "ply\nformat ascii 1.0\nelement e 1\nproperty int x\n";
    EXPECT_THAT(Error(head + line + "\nend_header\n"), HasSubstr("line 5")) << line;
  }
}

TEST(PlyHeader, QuotesNoControlCharacters) {
  const std::string error = Error("ply\nwhat \x1b[31mis this\r\nend_header\n");
  EXPECT_THAT(error, HasSubstr("'what ?[31mis this'"));
  EXPECT_LT(Error("ply\n" + std::string(5000, 'x') + "\n").size(), 200u);
}

TEST(PlySize, IsThatOfTheType) {
  EXPECT_EQ(PlySize(PlyType::kUint8), 1u);
  EXPECT_EQ(PlySize(PlyType::kInt16), 2u);
  EXPECT_EQ(PlySize(PlyType::kFloat), 4u);
  EXPECT_EQ(PlySize(PlyType::kDouble), 8u);
}

TEST(PlyHeader, RefusesAnElementNamedTwice) {
  std::string text = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 1000; ++i) text += "element e" + std::to_string(i) + " 0\n";
  EXPECT_EQ(Error(text + "end_header\n"), "no error");
  EXPECT_THAT(Error(text + "element e7 0\nend_header\n"), HasSubstr("line 1003"));
  for (int i = 1000; i < 10000; ++i) text += "property int p" + std::to_string(i) + "\n";
  EXPECT_EQ(Error(text + "end_header\n"), "no error");
  EXPECT_THAT(Error(text + "property int q\nend_header\n"), HasSubstr("more than 10000 elements and properties"));
}

TEST(PlyHeader, LimitsComments) {
  std::string text = "ply\nformat ascii 1.0\ncomment  a  word\ncomment\n";
  for (int i = 0; i < 200; ++i) text += "comment " + std::string(2000, 'x') + "\n";
  const PlyHeader header = ParsePlyHeader(text + "element vertex 0\nend_header\n", "file");
  ASSERT_EQ(header.comments.size(), 100u);
  EXPECT_EQ(header.comments[0], "a  word");
  EXPECT_EQ(header.comments[1], "");
  EXPECT_EQ(header.comments[2], std::string(1000, 'x'));
}

}  // namespace
}  // namespace oraclegs
