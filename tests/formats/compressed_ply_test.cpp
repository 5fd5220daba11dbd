#include "oraclegs/formats/codecs.h"

#include "formats/splats.h"
#include "oraclegs/formats/spatial_order.h"
#include "oraclegs/gaussians/selection.h"
#include "support/allocations.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(CompressedPly, RoundTripsWithinItsErrors) {
  const Gaussians all = PlausibleGaussians(3000), g = Picked(all, SpatialOrder(all));
  const std::string bytes = EncodeCompressedPly(g, 3, {"made by a test"});
  EXPECT_LT(bytes.size(), 3000u * (16 + 45) + 12 * 72 + 2000);
  const GaussianPly read = DecodeCompressedPly(bytes, "x.compressed.ply");
  EXPECT_EQ(read.sh_degree, 3);
  EXPECT_EQ(read.comments, std::vector<std::string>{"made by a test"});
  const SplatDistance d = DistanceOf(g, read.gaussians);
  EXPECT_LE(d.means, 8 * 0.5f / 1023);
  EXPECT_LE(d.log_scales, 6 * 0.5f / 1023);
  EXPECT_LE(d.rotation, 0.0025f);
  EXPECT_LE(d.opacity, 0.5f / 255 + 1e-6f);
  EXPECT_LE(d.color, 1.5f * 0.5f / 255);
  EXPECT_LE(d.first_degree, 8 / 512.f + 1e-6f);
  EXPECT_LE(d.higher_degrees, 8 / 512.f + 1e-6f);
}

TEST(CompressedPly, KeepsTheDegree) {
  for (int degree = 0; degree <= 3; ++degree) {
    const std::string bytes = EncodeCompressedPly(PlausibleGaussians(257), degree, {});
    EXPECT_EQ(bytes.find("element sh") != std::string::npos, degree > 0);
    EXPECT_EQ(DecodeCompressedPly(bytes, "x").sh_degree, degree);
  }
}

TEST(CompressedPly, OfEqualGaussiansIsExact) {
  Gaussians g = Gaussians::Zeros(3);
  Flat(g.means) = 2.5f;
  Table(g.quats).col(0) = 1;
  const GaussianPly read = DecodeCompressedPly(EncodeCompressedPly(g, 0, {}), "x");
  EXPECT_EQ(read.gaussians.means[8], 2.5f);
  EXPECT_EQ(read.gaussians.log_scales[8], 0);
  EXPECT_NEAR(read.gaussians.quats[8], 1, 1e-5f);
}

TEST(CompressedPly, ReadsFilesWithoutBoundsOfColor) {
  std::string bytes = EncodeCompressedPly(PlausibleGaussians(1), 0, {});
  for (const char* name : {"min_r", "min_g", "min_b", "max_r", "max_g", "max_b"}) {
    const std::string line = std::string("property float ") + name + "\n";
    bytes.erase(bytes.find(line), line.size());
  }
  const size_t chunk = bytes.find("end_header\n") + 11;
  bytes.erase(chunk + 12 * 4, 6 * 4);
  bytes[bytes.size() - 1] = '\xff';  // red
  EXPECT_NEAR(DecodeCompressedPly(bytes, "x").gaussians.sh[0], 0.5f / static_cast<float>(kConstantSh), 1e-5f);
}

TEST(CompressedPly, RefusesDamagedFiles) {
  const std::string good = EncodeCompressedPly(PlausibleGaussians(300), 1, {});
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    return DecodeError(DecodeCompressedPly, bytes.replace(bytes.find(from), from.size(), to));
  };
  EXPECT_THAT(with("element chunk 2", "element chunk 1"), HasSubstr("1 chunks for 300 Gaussians"));
  EXPECT_THAT(with("element vertex 300", "element vertex 99999999999999"), HasSubstr("promises 99999999999999"));
  EXPECT_THAT(with("element sh 300", "element sh 30"), HasSubstr("element 'sh' has 30 rows"));
  EXPECT_THAT(with("uint packed_scale", "int packed_scale"), HasSubstr("packed_scale"));
  EXPECT_THAT(with("float min_y", "float min_q"), HasSubstr("min_y"));
  EXPECT_THAT(with("little", "big"), HasSubstr("binary_little_endian"));
  EXPECT_THAT(with("uchar f_rest_8", "list uchar uchar f_rest_8"), HasSubstr("list"));
  EXPECT_THAT(with("packed_position", "position"), HasSubstr("is not a compressed splat"));
  EXPECT_THAT(DecodeError(DecodeCompressedPly, good.substr(0, good.size() - 1)), HasSubstr("promises 300"));
  std::string bad = good;
  StoreLittle(bad.data() + bad.find("end_header\n") + 11, INFINITY);
  EXPECT_THAT(DecodeError(DecodeCompressedPly, bad), HasSubstr("x of Gaussian 0 is"));
}

TEST(CompressedPly, RefusesBoundsThatOverflowBehindTheirArithmetic) {
  std::string bytes = EncodeCompressedPly(PlausibleGaussians(30), 0, {});
  StoreLittle(bytes.data() + bytes.find("end_header\n") + 11 + 15 * 4, 3e38f);  // max_r
  EXPECT_THAT(DecodeError(DecodeCompressedPly, bytes), HasSubstr("f_dc_0 of Gaussian"));
}

TEST(CompressedPly, TakesNoMemoryForRowsWithoutColumns) {
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement chunk 4000\nproperty uchar a\n";
  const std::string bytes =
      head + "element vertex 1024000\nproperty uchar packed_position\nend_header\n" + std::string(4000 + 1024000, '\0');
  AllocationCounter::Begin();
  EXPECT_THAT(DecodeError(DecodeCompressedPly, bytes), HasSubstr("packed_position"));
  AllocationCounter::End();
  EXPECT_LT(AllocationCounter::Bytes(), 10'000'000);
}

}  // namespace
}  // namespace oraclegs
