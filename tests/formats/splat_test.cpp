#include "oraclegs/formats/codecs.h"

#include <cmath>

#include "formats/splats.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(SplatFile, RoundTripsWithinItsErrors) {
  Gaussians g = PlausibleGaussians(2000);
  Table(g.sh).leftCols(3) = Table(g.sh).leftCols(3).cwiseMax(-1.7f).cwiseMin(1.7f);  // colors in [0,1]
  const std::string bytes = EncodeSplat(g);
  EXPECT_EQ(bytes.size(), 2000u * 32);
  const GaussianPly read = DecodeSplat(bytes, "x.splat");
  EXPECT_EQ(read.sh_degree, 0);
  const SplatDistance d = DistanceOf(HostCopy(g, 0), read.gaussians);
  EXPECT_EQ(d.means, 0);
  EXPECT_LE(d.log_scales, 1e-5f);
  EXPECT_LE(d.rotation, 0.012f);  // 1/256 a byte, and the error of the length
  EXPECT_LE(d.opacity, 0.5f / 255 + 1e-6f);
  EXPECT_LE(d.color, 0.5f / 255 + 1e-5f);
}

TEST(SplatFile, HasTheLayoutOfTheFormat) {
  Gaussians g = Gaussians::Zeros(1);
  g.means[1] = 2;
  g.quats[0] = 1;
  const std::string bytes = EncodeSplat(g);
  EXPECT_EQ(LoadLittle<float>(bytes, 4), 2);
  EXPECT_EQ(LoadLittle<float>(bytes, 12), 1);
  EXPECT_EQ(static_cast<uint8_t>(bytes[24]), 128);
  EXPECT_EQ(static_cast<uint8_t>(bytes[27]), 128);
  EXPECT_EQ(static_cast<uint8_t>(bytes[28]), 255);
  EXPECT_EQ(static_cast<uint8_t>(bytes[29]), 128);
}

TEST(SplatFile, ReadsScalesOfZero) {
  std::string bytes = EncodeSplat(PlausibleGaussians(1));
  StoreLittle(bytes.data() + 12, 0.f);
  EXPECT_NEAR(DecodeSplat(bytes, "x.splat").gaussians.log_scales[0], std::log(1e-30f), 0.01f);
}

TEST(SplatFile, RefusesDamagedFiles) {
  const std::string good = EncodeSplat(PlausibleGaussians(2));
  EXPECT_THAT(DecodeError(DecodeSplat, good.substr(1)), HasSubstr("expected a multiple of 32"));
  EXPECT_THAT(DecodeError(DecodeSplat, ""), HasSubstr("holds no Gaussians"));
  std::string bad = good;
  StoreLittle(bad.data() + 32, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(DecodeError(DecodeSplat, bad), HasSubstr("x of Gaussian 1"));
  bad = good;
  StoreLittle(bad.data() + 12, -1.f);
  EXPECT_THAT(DecodeError(DecodeSplat, bad), HasSubstr("scale_0 of Gaussian 0"));
}

}  // namespace
}  // namespace oraclegs
