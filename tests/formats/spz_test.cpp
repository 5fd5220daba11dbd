#include "oraclegs/formats/codecs.h"

#include "formats/splats.h"
#include "oraclegs/formats/gzip.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

std::string Unpacked(const std::string& spz) { return Gunzip(spz, "x").Next(1 << 30); }

TEST(Spz, RoundTripsWithinItsErrors) {
  Gaussians g = PlausibleGaussians(3000);
  Flat(g.opacity_logits) = Flat(g.opacity_logits).abs();  // none is faint
  Table(g.sh).leftCols(3) = Table(g.sh).leftCols(3).cwiseMax(-3.f).cwiseMin(3.f);
  Table(g.sh).rightCols(kShFloats - 3) = Table(g.sh).rightCols(kShFloats - 3).cwiseMax(-0.9f).cwiseMin(0.9f);
  const GaussianPly read = DecodeSpz(EncodeSpz(g, 3), "x.spz");
  EXPECT_EQ(read.sh_degree, 3);
  const SplatDistance d = DistanceOf(g, read.gaussians);
  EXPECT_LE(d.means, std::exp(-4.f) / 32 * 1.2f);
  EXPECT_LE(d.log_scales, 1 / 32.f + 1e-5f);
  EXPECT_LE(d.rotation, 0.0025f);  // what is left for the largest component
  EXPECT_LE(d.opacity, 0.5f / 255 + 1e-6f);
  EXPECT_LE(d.color, 0.5f / 255 / 0.15f * static_cast<float>(kConstantSh) + 1e-5f);
  EXPECT_LE(d.first_degree, 1 / 64.f + 1e-6f);
  EXPECT_LE(d.higher_degrees, 1 / 64.f + 1e-6f);
}

TEST(Spz, SpendsFewerValuesOnFaintGaussians) {
  const auto error = [](float logit) {
    const Gaussians g = PlausibleGaussians(500);
    Flat(g.opacity_logits) = logit;
    return DistanceOf(g, DecodeSpz(EncodeSpz(g, 3), "x.spz").gaussians).higher_degrees;
  };
  EXPECT_LE(error(-2), 1 / 32.f + 1e-6f);  // opacity 0.12
  EXPECT_LE(error(-4), 1 / 16.f + 1e-6f);  // 0.02
  EXPECT_GT(error(-4), error(-2));
  EXPECT_GT(error(-2), error(2));
}

TEST(Spz, KeepsTheOrderAndTheDegree) {
  for (int degree = 0; degree <= 3; ++degree) {
    const Gaussians g = PlausibleGaussians(40);
    const GaussianPly read = DecodeSpz(EncodeSpz(g, degree), "x.spz");
    EXPECT_EQ(read.sh_degree, degree);
    EXPECT_LE(DistanceOf(HostCopy(g, degree), read.gaussians).means, 0.01f);
    EXPECT_EQ(Table(read.gaussians.sh).rightCols(kShFloats - 3 * ShCount(degree)).abs().sum(), 0);
  }
}

TEST(Spz, OfVersionTwoIsLessExactInRotationsOnly) {
  const Gaussians g = PlausibleGaussians(500);
  const std::string bytes = EncodeSpz(g, 0, SpzVersion::k2);
  EXPECT_EQ(Unpacked(bytes).size(), 16u + 500 * 19);
  const GaussianPly read = DecodeSpz(bytes, "x.spz");
  EXPECT_LE(DistanceOf(g, read.gaussians).rotation, 0.13f);  // w follows from the others, badly where it is small
  EXPECT_LE(DistanceOf(g, read.gaussians).opacity, 0.5f / 255 + 1e-6f);
}

TEST(Spz, HasTheLayoutOfTheFormat) {
  Gaussians g = Gaussians::Zeros(1);
  Flat(g.log_scales) = -4;
  g.means[0] = 1;
  g.means[1] = 2;
  g.quats[0] = 1;
  g.opacity_logits[0] = 15;
  g.sh[3] = 0.5f;  // odd in y
  const std::string bytes = Unpacked(EncodeSpz(g, 1));
  ASSERT_EQ(bytes.size(), 16u + 20 + 9);
  EXPECT_EQ(bytes.substr(0, 4), "NGSP");
  EXPECT_EQ(bytes[4], 3);
  EXPECT_EQ(bytes[8], 1);
  EXPECT_EQ(bytes[12], 1);
  const int bits = bytes[13];
  EXPECT_EQ(LoadLittle<uint16_t>(bytes, 16) | (bytes[18] << 16), 1 << bits);
  EXPECT_EQ(LoadLittle<int32_t>(bytes, 18) >> 8, -2 << bits);  // y points up in the file
  EXPECT_EQ(static_cast<uint8_t>(bytes[25]), 255);             // opacity
  EXPECT_EQ(static_cast<uint8_t>(bytes[26]), 128);             // color 0.5
  EXPECT_EQ(static_cast<uint8_t>(bytes[29]), 96);              // (-4 + 10) * 16
  EXPECT_EQ(static_cast<uint8_t>(bytes[35]) >> 6, 3);          // w is the largest component
  EXPECT_EQ(static_cast<uint8_t>(bytes[36]), 64);
}

TEST(Spz, FarGaussiansStopAtTheBorderAndCostOthersNothing) {
  Gaussians g = PlausibleGaussians(100);
  g.means[0] = 1e8f;
  const GaussianPly read = DecodeSpz(EncodeSpz(g, 0), "x.spz");
  EXPECT_NEAR(read.gaussians.means[0], 8192, 1);  // 24 bits, 10 of them after the point
  EXPECT_NEAR(read.gaussians.means[3], g.means[3], 0.001f);
}

TEST(Spz, FarFromTheOriginKeepsWhat24BitsHold) {
  const Gaussians g = PlausibleGaussians(500);
  Flat(g.means) += 10000;
  const GaussianPly read = DecodeSpz(EncodeSpz(g, 0), "x.spz");
  EXPECT_LE(DistanceOf(g, read.gaussians).means, 0.0011f);  // 9 bits: 1/16 of a deviation
}

TEST(Spz, KeepsTheMarkOfAntialiasedTraining) {
  const Gaussians g = PlausibleGaussians(5);
  EXPECT_TRUE(DecodeSpz(EncodeSpz(g, 0, SpzVersion::k3, true), "x").antialiased);
  EXPECT_FALSE(DecodeSpz(EncodeSpz(g, 0), "x").antialiased);
}

TEST(Spz, RefusesDamagedFiles) {
  const std::string good = Unpacked(EncodeSpz(PlausibleGaussians(9), 2));
  const auto error = [](std::string bytes) { return DecodeError(DecodeSpz, Gzip(bytes)); };
  const auto with = [&](size_t at, char value) {
    std::string bytes = good;
    bytes[at] = value;
    return bytes;
  };
  EXPECT_THAT(DecodeError(DecodeSpz, "ply\n"), HasSubstr("not compressed by gzip"));
  EXPECT_THAT(error("NGSP"), HasSubstr("is not a splat in SPZ format"));
  EXPECT_THAT(error(with(0, 'X')), HasSubstr("is not a splat in SPZ format"));
  EXPECT_THAT(error(with(4, 5)), HasSubstr("version 5"));
  EXPECT_THAT(error(with(12, 5)), HasSubstr("degree 5"));
  EXPECT_THAT(error(with(13, 40)), HasSubstr("40 fractional bits"));
  EXPECT_THAT(error(with(11, 127)), HasSubstr("promises"));
  EXPECT_THAT(error(good.substr(0, good.size() - 1)), HasSubstr("promises 9 Gaussians"));
  EXPECT_THAT(error(good.substr(0, 8) + std::string(8, '\0')), HasSubstr("holds no Gaussians"));
}

TEST(Spz, ReadsEqualGaussiansButNoBombOfThem) {
  EXPECT_EQ(DecodeSpz(EncodeSpz(Gaussians::Zeros(100000), 0), "x.spz").gaussians.size(), 100000);
  const std::string bomb = EncodeSpz(Gaussians::Zeros(300000), 0);
  EXPECT_THAT(DecodeError(DecodeSpz, bomb), HasSubstr("promises 300000 Gaussians in"));
}

}  // namespace
}  // namespace oraclegs
