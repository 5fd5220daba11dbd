#include "oraclegs/formats/spz_container.h"

#include "formats/splats.h"
#include "formats/spz_version4.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/gzip.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

/// The file's Gaussians with 24 more bytes of harmonics each, which make degree 3 four.
std::string WithAFourthDegree(const std::string& spz) {
  const std::string bare = BareSpz(spz);
  const auto n = LoadLittle<uint32_t>(bare, 8);
  const SpzLayout at(n, 3, 3);
  std::string file = bare.substr(0, kSpzHeader + at.sh);
  file[12] = 4;
  for (uint64_t i = 0; i < n; ++i) file += bare.substr(kSpzHeader + at.sh + 45 * i, 45) + std::string(27, '\1');
  return file;
}

void ExpectSameSplat(const GaussianPly& a, const GaussianPly& b) {
  EXPECT_EQ(a.sh_degree, b.sh_degree);
  const SplatDistance d = DistanceOf(a.gaussians, b.gaussians);
  EXPECT_EQ(d.means + d.log_scales + d.rotation + d.opacity + d.color + d.first_degree + d.higher_degrees, 0);
}

TEST(UnpackSpz, ReadsZstdAndWhatIsNotPacked) {
  for (const int degree : {0, 2, 3}) {
    const std::string spz = EncodeSpz(PlausibleGaussians(70), degree, SpzVersion::k3, true);
    const GaussianPly expected = DecodeSpz(spz, "x");
    ExpectSameSplat(DecodeSpz(SpzOfVersion4(spz), "x"), expected);
    ExpectSameSplat(DecodeSpz(BareSpz(spz), "x"), expected);
    EXPECT_TRUE(DecodeSpz(SpzOfVersion4(spz), "x").antialiased);
    EXPECT_TRUE(DecodeSpz(SpzOfVersion4(spz), "x").warnings.empty());
  }
}

TEST(UnpackSpz, ReadsHalvesOfVersion1) {
  std::string file;
  for (const uint32_t number : {kSpzMagic, 1u, 1u}) PutNumber(number, &file);
  file += std::string(4, '\0');
  for (const int half : {0x3c00, 0xc500, 0x0001}) PutNumber(static_cast<uint16_t>(half), &file);  // 1, -5, 2^-24
  file += std::string(1 + 3 + 3, '\x80') + std::string(3, '\x80');
  const GaussianPly read = DecodeSpz(file, "x");
  EXPECT_EQ(read.gaussians.means[0], 1);
  EXPECT_EQ(read.gaussians.means[1], 5);  // y points up in the file
  EXPECT_EQ(read.gaussians.means[2], -std::ldexp(1.f, -24));
  EXPECT_GT(read.gaussians.quats[0], 0.99f);
}

TEST(UnpackSpz, LeavesOutAFourthDegreeAndSaysSo) {
  const std::string spz = EncodeSpz(PlausibleGaussians(7), 3);
  const GaussianPly read = DecodeSpz(WithAFourthDegree(spz), "x");
  ExpectSameSplat(read, DecodeSpz(spz, "x"));
  EXPECT_THAT(read.warnings, testing::ElementsAre(HasSubstr("degree 4")));
}

TEST(UnpackSpz, SaysThatExtensionsArePassedOver) {
  const std::string spz = EncodeSpz(PlausibleGaussians(7), 1);
  const GaussianPly read = DecodeSpz(SpzOfVersion4(spz, std::string(20, 'e')), "x");
  ExpectSameSplat(read, DecodeSpz(spz, "x"));
  EXPECT_THAT(read.warnings, testing::ElementsAre(HasSubstr("extensions")));
}

TEST(PackSpz, HasTheLayoutOfVersion4) {
  const std::string file = EncodeSpz(PlausibleGaussians(70), 1, SpzVersion::k4, true);
  EXPECT_EQ(file.substr(0, 4), "NGSP");
  EXPECT_EQ(LoadLittle<uint32_t>(file, 4), 4u);
  EXPECT_EQ(LoadLittle<uint32_t>(file, 8), 70u);
  EXPECT_EQ(file[12], 1);                          // degree
  EXPECT_EQ(file[14], 1);                          // antialiased, no extensions
  EXPECT_EQ(file[15], 6);                          // streams
  EXPECT_EQ(LoadLittle<uint32_t>(file, 16), 32u);  // where the table is
  EXPECT_EQ(file.substr(20, 12), std::string(12, '\0'));
  const uint64_t bytes_per_gaussian[] = {9, 1, 3, 3, 4, 9};
  size_t end = 32 + 6 * 16;
  for (size_t s = 0; s < 6; ++s) {
    EXPECT_EQ(LoadLittle<uint64_t>(file, 32 + 16 * s + 8), 70 * bytes_per_gaussian[s]);
    EXPECT_EQ(LoadLittle<uint32_t>(file, end), 0xfd2fb528u) << "a frame of zstd begins so";
    end += LoadLittle<uint64_t>(file, 32 + 16 * s);
  }
  EXPECT_EQ(end, file.size());
  EXPECT_EQ(EncodeSpz(PlausibleGaussians(70), 0, SpzVersion::k4)[15], 5);
}

TEST(PackSpz, KeepsTheSameNumbersInEitherContainer) {
  for (const int degree : {0, 3}) {
    const Gaussians g = PlausibleGaussians(500);
    const GaussianPly expected = DecodeSpz(EncodeSpz(g, degree), "x");
    ExpectSameSplat(DecodeSpz(EncodeSpz(g, degree, SpzVersion::k4), "x"), expected);
    ExpectSameSplat(DecodeSpz(SpzOfVersion4(EncodeSpz(g, degree)), "x"), expected);
  }
}

TEST(UnpackSpz, IsNoBombOfZstd) {
  const std::string bomb = EncodeSpz(Gaussians::Zeros(300000), 0, SpzVersion::k4);
  EXPECT_LT(bomb.size(), 10000u);
  EXPECT_THAT(DecodeError(DecodeSpz, bomb), HasSubstr("promises 300000 Gaussians in"));
  // A stream that unpacks to more than its Gaussians need ends where they do; the table's word is not taken.
  std::string file = bomb;
  StoreLittle(file.data() + 8, uint32_t{9});
  EXPECT_THAT(DecodeError(DecodeSpz, file), HasSubstr("stream 0 is damaged, or not of 9 Gaussians"));
  std::string all = EncodeSpz(PlausibleGaussians(9), 0, SpzVersion::k4);
  StoreLittle(all.data() + 8, ~uint32_t{0});
  EXPECT_THAT(DecodeError(DecodeSpz, all), HasSubstr("promises 4294967295 Gaussians"));
}

TEST(UnpackSpz, RefusesDamagedStreams) {
  const std::string good = SpzOfVersion4(EncodeSpz(PlausibleGaussians(9), 2));
  const auto with = [&](size_t at, char value) {
    std::string bytes = good;
    bytes[at] = value;
    return DecodeError(DecodeSpz, bytes);
  };
  EXPECT_THAT(with(4, 9), HasSubstr("version 9"));
  EXPECT_THAT(with(8, 10), HasSubstr("not of 10 Gaussians"));
  EXPECT_THAT(with(11, 127), HasSubstr("promises"));
  EXPECT_THAT(with(15, 5), HasSubstr("table of 5 streams"));
  EXPECT_THAT(with(17, 127), HasSubstr("table of 6 streams"));
  EXPECT_THAT(with(16, 0), HasSubstr("table of 6 streams"));
  EXPECT_THAT(with(39, 1), HasSubstr("ends within its stream 0"));
  EXPECT_THAT(with(32 + 6 * 16, 0), HasSubstr("stream 0 is damaged"));
  for (size_t length = 8; length < good.size(); length += 7) {
    EXPECT_NE(DecodeError(DecodeSpz, good.substr(0, length)), "no error") << length;
  }
}

}  // namespace
}  // namespace oraclegs
