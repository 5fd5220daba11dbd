#include "oraclegs/gaussians/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "oraclegs/core/files.h"
#include "oraclegs/core/statistics.h"
#include "support/buffers.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

Gaussians RandomGaussians(int64_t n) {
  Gaussians g = Gaussians::Empty(n);
  uint64_t seed = 2;
  g.ForEach([&](const char*, Buffer<float>& t) { t = RandomNormal(t.shape(), seed++); });
  return g;
}

void ExpectSameBits(const Gaussians& a, const Gaussians& b) {
  std::vector<Buffer<float>> left;
  a.ForEach([&](const char*, const Buffer<float>& t) { left.push_back(t); });
  size_t i = 0;
  b.ForEach([&](const char* name, const Buffer<float>& t) { EXPECT_TRUE(SameBytes(left[i++], t)) << name; });
}

/// The message of the InputError that reading gives.
std::string ReadError(const std::filesystem::path& path) {
  try {
    ReadGaussianPly(path);
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(path.string()));
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.what();
  }
  return "no error";
}

class GaussianPlyFile : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& bytes) {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }

  TempDir dir_;
  std::filesystem::path path_ = dir_ / "cloud.ply";
};

TEST_F(GaussianPlyFile, RoundTripsBitsAtEveryDegree) {
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    const Gaussians g = RandomGaussians(37);
    WriteGaussianPly(path_, g, degree);
    const GaussianPly read = ReadGaussianPly(path_);
    EXPECT_EQ(read.sh_degree, degree);
    Gaussians expected = g;
    expected.sh = g.sh.Clone();
    Table(expected.sh).rightCols(kShFloats - 3 * ShCount(degree)).setZero();
    ExpectSameBits(read.gaussians, expected);
  }
}

TEST_F(GaussianPlyFile, HasTheLayoutOfViewers) {
  Gaussians g = Gaussians::Zeros(1);
  g.means[1] = 2;
  g.sh[2] = 3;
  g.sh[3] = 4;   // red of the first higher coefficient
  g.sh[47] = 5;  // blue of the last
  g.opacity_logits[0] = 6;
  g.log_scales[0] = 7;
  g.quats[0] = 1;
  WriteGaussianPly(path_, g);
  const std::string bytes = ReadFile(path_);
  const std::string end = "end_header\n";
  const size_t body = bytes.find(end) + end.size();
  EXPECT_THAT(bytes, testing::StartsWith("ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"));
  EXPECT_THAT(bytes,
              HasSubstr("float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float f_dc_0\n"));
  ASSERT_EQ(bytes.size() - body, 62 * sizeof(float));
  float row[62];
  std::memcpy(row, bytes.data() + body, sizeof(row));
  EXPECT_EQ(row[1], 2);
  EXPECT_EQ(row[3] + row[4] + row[5], 0);  // normals
  EXPECT_EQ(row[8], 3);
  EXPECT_EQ(row[9], 4);   // f_rest_0
  EXPECT_EQ(row[53], 5);  // f_rest_44
  EXPECT_EQ(row[54], 6);
  EXPECT_EQ(row[55], 7);
  EXPECT_EQ(row[58], 1);
}

TEST_F(GaussianPlyFile, FindsPropertiesByName) {
  Write(
      "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info x\r\nelement camera 2\r\nproperty float f\r\n"
      "property list uchar int ids\r\nelement vertex 2\r\nproperty float rot_3\r\nproperty double rot_2\r\n"
      "property float rot_1\r\nproperty float rot_0\r\nproperty uchar red\r\nproperty float opacity\r\n"
      "property list uchar float extra\r\nproperty float scale_2\r\nproperty float scale_1\r\nproperty float "
      "scale_0\r\n"
      "property float f_dc_2\r\nproperty float f_dc_0\r\nproperty float f_dc_1\r\nproperty double z\r\n"
      "property float y\r\nproperty short x\r\nelement face 1\r\nproperty list uchar int v\r\nend_header\r\n"
      "1.5 3 7 8 9\n2.5 0\n"
      "0 0 0 1 255 -1.5 2 8 9 30 20 10 3 1 2 +0.25 -7 -3\n"
      "0 0 1e0 0 255 1.5 0 31 21 11\t6 4 5 1e-3 7 3\n3 0 1 2\n");
  const GaussianPly read = ReadGaussianPly(path_);
  ASSERT_EQ(read.gaussians.size(), 2);
  EXPECT_EQ(read.sh_degree, 0);
  const Gaussians& g = read.gaussians;
  EXPECT_THAT(g.means.span(), testing::ElementsAre(-3, -7, 0.25f, 3, 7, 1e-3f));
  EXPECT_THAT(g.quats.Rows(1, 2).span(), testing::ElementsAre(0, 1, 0, 0));
  EXPECT_THAT(g.log_scales.Rows(0, 1).span(), testing::ElementsAre(10, 20, 30));
  EXPECT_THAT(g.sh.Rows(0, 1).span().first(3), testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(g.sh.Rows(1, 2).span().first(3), testing::ElementsAre(4, 5, 6));
  EXPECT_THAT(g.opacity_logits.span(), testing::ElementsAre(-1.5f, 1.5f));
}

TEST_F(GaussianPlyFile, RefusesTruncation) {
  WriteGaussianPly(path_, RandomGaussians(2), 0);
  const std::string whole = ReadFile(path_);
  for (size_t length = 0; length < whole.size(); length += 37) {
    EXPECT_NE(ReadError(Write(whole.substr(0, length))), "no error") << length;
  }
  EXPECT_EQ(ReadError(Write(whole)), "no error");
}

TEST_F(GaussianPlyFile, RefusesACountLargerThanTheFile) {
  WriteGaussianPly(path_, RandomGaussians(2), 3);
  const std::string good = ReadFile(path_);
  for (const char* count : {"3", "1000000000000000000", "18446744073709551615"}) {
    std::string bad = good;
    bad.replace(bad.find("vertex 2"), 8, std::string("vertex ") + count);
    EXPECT_THAT(ReadError(Write(bad)), HasSubstr("cut short"));
    std::string ascii = bad;
    ascii.replace(ascii.find("binary_little_endian"), 20, "ascii");
    EXPECT_NE(ReadError(Write(ascii)), "no error");
    std::string earlier = bad;  // the same lie told of an element that is only skipped
    earlier.replace(earlier.find("element vertex"), 14,
                    std::string("element other ") + count + "\nproperty int i\nelement vertex");
    EXPECT_NE(ReadError(Write(earlier)), "no error");
  }
}

TEST_F(GaussianPlyFile, NamesTheMistake) {
  EXPECT_THAT(ReadError(dir_ / "absent.ply"), HasSubstr("absent.ply"));
  EXPECT_THAT(ReadError(Write("PNG\n")), HasSubstr("not a PLY"));
  EXPECT_THAT(ReadError(Write("ply\nend_header\n")), HasSubstr("format"));
  EXPECT_THAT(ReadError(Write("ply\nformat ascii 2.0\nend_header\n")), HasSubstr("line 2"));
  EXPECT_THAT(ReadError(Write("ply\nformat ascii 1.0\nend_header\n")), HasSubstr("no element 'vertex'"));
  EXPECT_THAT(ReadError(Write("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n")), HasSubstr("line 3"));
  EXPECT_THAT(ReadError(Write("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")), HasSubstr("no Gaussians"));
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\n";
  EXPECT_THAT(ReadError(Write(head + "property float x\nend_header\n1\n")), HasSubstr("no property 'y'"));
  EXPECT_THAT(ReadError(Write(head + "property float x\nproperty float x\nend_header\n1\n")), HasSubstr("line 5"));
  EXPECT_THAT(ReadError(Write(head + "property quad x\nend_header\n1\n")), HasSubstr("line 4"));
  EXPECT_THAT(ReadError(Write(head + "property list float int x\nend_header\n1\n")), HasSubstr("line 4"));
  EXPECT_THAT(ReadError(Write(head + "property float f_rest_0\nend_header\n1\n")), HasSubstr("1 f_rest"));
  EXPECT_THAT(ReadError(Write("ply\nformat ascii 1.0\nproperty float x\nend_header\n")), HasSubstr("line 3"));
  EXPECT_THAT(ReadError(Write("ply\nwhat \x1b[31mis this\nend_header\n")), HasSubstr("?[31m"));
}

TEST_F(GaussianPlyFile, RefusesManyRowsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Gaussians g = RandomGaussians(5);
    g.log_scales[3 * 3 + 1] = bad;
    WriteGaussianPly(path_, g);
    EXPECT_THAT(ReadError(path_), HasSubstr("scale_1 of Gaussian 3"));
  }
}

TEST_F(GaussianPlyFile, LeavesOutOneBadRowAndSaysSo) {
  Gaussians g = RandomGaussians(20);
  g.sh[5 * kShFloats + 1] = std::numeric_limits<float>::quiet_NaN();
  WriteGaussianPly(path_, g, 1, {}, {std::vector<float>(20, 0.5f)});
  const GaussianPly read = ReadGaussianPly(path_);
  EXPECT_EQ(read.gaussians.size(), 19);
  EXPECT_EQ(read.marks.support.size(), 19u);
  EXPECT_EQ(read.gaussians.means[5 * 3], g.means[6 * 3]);
  EXPECT_THAT(read.warnings, testing::ElementsAre(HasSubstr("1 of 20 Gaussians")));
}

/// A line of a text file with one Gaussian of these properties, numbered from 1 in their order.
std::string OneRow(const std::vector<std::string>& properties) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 1\n", row;
  for (const std::string& name : properties) {
    text += "property float " + name + "\n";
    row += std::to_string(row.empty() ? 1 : 1 + std::count(row.begin(), row.end(), ' ')) + " ";
  }
  return text + "end_header\n" + row + "\n";
}

TEST_F(GaussianPlyFile, ReadsDiscsOfTwoScales) {
  Write(OneRow({"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "rot_0", "rot_1", "rot_2",
                "rot_3"}));
  const GaussianPly read = ReadGaussianPly(path_);
  EXPECT_EQ(read.gaussians.log_scales[0], 8);
  EXPECT_NEAR(read.gaussians.log_scales[2], 8 + std::log(1e-3), 1e-4);
  EXPECT_EQ(read.gaussians.quats[0], 10);
  EXPECT_THAT(read.warnings, testing::ElementsAre(HasSubstr("two scales")));
}

TEST_F(GaussianPlyFile, AppliesTheFilterOfMipSplatting) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 1\n";
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3", "filter_3D"}) {
    text += std::string("property float ") + name + "\n";
  }
  // Standard deviations 3, 1 and 0 with a filter of 4: 5, sqrt(17) and 4.
  const GaussianPly read = ReadGaussianPly(Write(text + "end_header\n0 0 0 0 0 0 0 1.0986123 0 -60 1 0 0 0 4\n"));
  EXPECT_NEAR(read.gaussians.log_scales[0], std::log(5), 1e-5);
  EXPECT_NEAR(read.gaussians.log_scales[1], std::log(17) / 2, 1e-5);
  EXPECT_NEAR(read.gaussians.log_scales[2], std::log(4), 1e-5);
  EXPECT_LT(read.gaussians.opacity_logits[0], -50);  // a disc without thickness shows nothing from the side
  EXPECT_TRUE(read.antialiased);
  EXPECT_THAT(read.warnings, testing::ElementsAre(HasSubstr("the 3D filter of Mip-Splatting")));
  const GaussianPly even = ReadGaussianPly(Write(text + "end_header\n0 0 0 0 0 0 9 0 0 0 1 0 0 0 1\n"));
  EXPECT_NEAR(Sigmoid(even.gaussians.opacity_logits[0]), std::pow(0.5, 1.5), 1e-3);
  const GaussianPly none = ReadGaussianPly(Write(text + "end_header\n0 0 0 0 0 0 9 0 0 0 1 0 0 0 0\n"));
  EXPECT_NEAR(none.gaussians.opacity_logits[0], 9, 1e-3);
}

TEST_F(GaussianPlyFile, ReadsHarmonicsOfDegreeFourToDegreeThree) {
  std::vector<std::string> names = {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (int i = 0; i < 72; ++i) names.push_back("f_rest_" + std::to_string(i));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    names.emplace_back(name);
  }
  const GaussianPly read = ReadGaussianPly(Write(OneRow(names)));
  EXPECT_EQ(read.sh_degree, 3);
  EXPECT_EQ(read.gaussians.sh[3], 7);                 // red of the first coefficient: f_rest_0
  EXPECT_EQ(read.gaussians.sh[4], 7 + 24);            // green of it
  EXPECT_EQ(read.gaussians.sh[47], 7 + 2 * 24 + 14);  // blue of the last one of degree 3
  EXPECT_EQ(read.gaussians.opacity_logits[0], 79);
  EXPECT_THAT(read.warnings, testing::ElementsAre(HasSubstr("degree 4")));
}

TEST(SaysAntialiased, GoesByTheLastCommentOfEitherProgram) {
  EXPECT_FALSE(SaysAntialiased({"made antialiased"}));
  EXPECT_TRUE(SaysAntialiased({"antialiased 1"}));
  EXPECT_FALSE(SaysAntialiased({"antialiased 1", "SplatRenderMode: default"}));
  EXPECT_TRUE(SaysAntialiased({"antialiased 0", "SplatRenderMode: mip", "Generated by X"}));
}

TEST_F(GaussianPlyFile, KeepsTheMarkOfAntialiasedTraining) {
  WriteGaussianPly(path_, RandomGaussians(2), 0, {kAntialiasedComment});
  EXPECT_TRUE(ReadGaussianPly(path_).antialiased);
  WriteGaussianPly(path_, RandomGaussians(2), 0, {"SplatRenderMode: default"});
  EXPECT_FALSE(ReadGaussianPly(path_).antialiased);
}

TEST_F(GaussianPlyFile, TakesDenormalNumbersForWhatTheyAre) {
  constexpr float kTiny = std::numeric_limits<float>::denorm_min();
  Gaussians g = RandomGaussians(3);
  g.means[0] = kTiny, g.means[1] = -kTiny, g.sh[0] = kTiny;
  WriteGaussianPly(path_, g);
  const Gaussians read = ReadGaussianPly(path_).gaussians;
  EXPECT_EQ(read.means[0], kTiny);
  EXPECT_EQ(read.means[1], -kTiny);
  EXPECT_EQ(read.sh[0], kTiny);
  g.quats.Rows(1, 2).SetZero();
  g.quats[5] = kTiny;
  WriteGaussianPly(path_, g);
  EXPECT_THAT(ReadGaussianPly(path_).gaussians.quats.Rows(1, 2).span(), testing::ElementsAre(0, 1, 0, 0));
}

TEST_F(GaussianPlyFile, AcceptsOpacityZeroAndOne) {
  Gaussians g = RandomGaussians(3);
  g.opacity_logits[0] = std::numeric_limits<float>::infinity();
  g.opacity_logits[1] = -std::numeric_limits<float>::infinity();
  const float usual = g.opacity_logits[2];
  for (const int degree : {0, 3}) {
    WriteGaussianPly(path_, g, degree);
    const GaussianPly read = ReadGaussianPly(path_);
    EXPECT_THAT(read.gaussians.opacity_logits.span(), testing::ElementsAre(15, -15, usual));
  }
  g.opacity_logits[1] = std::numeric_limits<float>::quiet_NaN();
  WriteGaussianPly(path_, g);
  EXPECT_THAT(ReadError(path_), HasSubstr("opacity of Gaussian 1"));
}

TEST_F(GaussianPlyFile, ReadsAsciiAtTheLimits) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "f_dc_0\n"
      "property float f_dc_1\nproperty float f_dc_2\nproperty float opacity\nproperty float scale_0\nproperty float "
      "scale_1\n"
      "property float scale_2\nproperty float rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
      "end_header\n";
  EXPECT_THAT(ReadError(Write(head + "1 2 nan 0 0 0 0 0 0 0 1 0 0 0\n")), HasSubstr("z of Gaussian 0"));
  EXPECT_THAT(ReadError(Write(head + "1 1e400 0 0 0 0 0 0 0 0 1 0 0 0\n")), HasSubstr("y of Gaussian 0"));
  EXPECT_THAT(ReadError(Write(head + "1 1e50 0 0 0 0 0 0 0 0 1 0 0 0\n")), HasSubstr("y of Gaussian 0"));
  EXPECT_THAT(ReadError(Write(head + "1 2 3x 0 0 0 0 0 0 0 1 0 0 0\n")), HasSubstr("not a number"));
  EXPECT_EQ(ReadError(Write(head + "1 1e-400 0 0 0 0 0 0 0 0 1 0 0 0")), "no error");  // the last needs no newline
}

TEST_F(GaussianPlyFile, KeepsComments) {
  const Gaussians g = RandomGaussians(5);
  WriteGaussianPly(path_, g, 1, {"made with X", "two\nlines\r"});
  const GaussianPly read = ReadGaussianPly(path_);
  EXPECT_EQ(read.comments, (std::vector<std::string>{"made with X", "two lines "}));
  EXPECT_TRUE(Equal(read.gaussians.means, g.means));
  WriteGaussianPly(path_, g, 1);
  EXPECT_TRUE(ReadGaussianPly(path_).comments.empty());
}

TEST_F(GaussianPlyFile, KeepsMarks) {
  const Gaussians g = RandomGaussians(3);
  WriteGaussianPly(path_, g, 1, {}, {{0, 0.5f, 1}, {1, 0.25f, 0}});
  const GaussianPly read = ReadGaussianPly(path_);
  EXPECT_EQ(read.sh_degree, 1);
  EXPECT_EQ(read.marks.support, (std::vector<float>{0, 0.5f, 1}));
  EXPECT_EQ(read.marks.uncertainty, (std::vector<float>{1, 0.25f, 0}));
  EXPECT_TRUE(Equal(read.gaussians.quats, g.quats));
  WriteGaussianPly(path_, g, 1, {}, {{}, {1, 0.25f, 0}});
  const GaussianPly unsupported = ReadGaussianPly(path_);
  EXPECT_TRUE(unsupported.marks.support.empty());
  EXPECT_EQ(unsupported.marks.uncertainty, read.marks.uncertainty);
  WriteGaussianPly(path_, g, 1);
  EXPECT_TRUE(ReadGaussianPly(path_).marks.support.empty());
  EXPECT_THROW(WriteGaussianPly(path_, g, 1, {}, {{0.5f}}), ShapeError);
}

TEST_F(GaussianPlyFile, RefusesMarksOutOfRange) {
  for (const float bad : {-0.1f, 1.1f, std::numeric_limits<float>::quiet_NaN()}) {
    WriteGaussianPly(path_, RandomGaussians(2), 0, {}, {{0.5f, bad}});
    EXPECT_THAT(ReadError(path_), HasSubstr("support of vertex 1"));
    WriteGaussianPly(path_, RandomGaussians(2), 0, {}, {{}, {0.5f, bad}});
    EXPECT_THAT(ReadError(path_), HasSubstr("uncertainty of vertex 1"));
  }
}

TEST_F(GaussianPlyFile, RefusesToWriteWrongShapes) {
  Gaussians g = RandomGaussians(3);
  EXPECT_THROW(WriteGaussianPly(path_, g, 4), ShapeError);
  EXPECT_THROW(WriteGaussianPly(dir_.path(), g, 0), RunError);
  g.sh = Buffer<float>::Zeros({3, 9, 3});
  EXPECT_THROW(WriteGaussianPly(path_, g), ShapeError);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace oraclegs
