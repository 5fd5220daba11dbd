#include "oraclegs/formats/codecs.h"

#include <nlohmann/json.hpp>

#include "formats/splats.h"
#include "oraclegs/core/files.h"
#include "oraclegs/formats/spatial_order.h"
#include "oraclegs/formats/webp.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/gaussians/selection.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(SogReader, RoundTripsWithinItsErrors) {
  const Gaussians all = PlausibleGaussians(3000), g = Picked(all, SpatialOrder(all));
  const GaussianPly read = DecodeSog(EncodeSog(g, 3), "x.sog");
  EXPECT_EQ(read.sh_degree, 3);
  const SplatDistance d = DistanceOf(g, read.gaussians);
  EXPECT_LE(d.means, 3.5f / 65535 * 5);
  EXPECT_LE(d.log_scales, 0.15f);  // at the ends of the range, where few values are
  EXPECT_LE(d.rotation, 0.012f);
  EXPECT_LE(d.opacity, 0.5f / 255 + 1e-6f);
  EXPECT_LE(d.color, 0.05f);
  EXPECT_LE(d.higher_degrees, 0.9f);  // random ones, which no set of few can meet
}

TEST(SogReader, MeetsHarmonicsThatAreAlike) {
  Gaussians g = PlausibleGaussians(2000);
  for (int64_t i = 0; i < 2000; ++i) {
    for (int k = 3; k < kShFloats; ++k) g.sh[i * kShFloats + k] = 0.01f * static_cast<float>((i % 20) * (k % 5));
  }
  const GaussianPly read = DecodeSog(EncodeSog(g, 3), "x.sog");
  EXPECT_LE(DistanceOf(g, read.gaussians).higher_degrees, 0.02f);
}

TEST(SogReader, IsExactFarFromTheOrigin) {
  const Gaussians g = PlausibleGaussians(2000);
  Flat(g.means) += 10000;
  EXPECT_LE(DistanceOf(g, DecodeSog(EncodeSog(g, 0), "x.sog").gaussians).means, 0.001f);  // a step of a float there
}

TEST(SogReader, OneValueFarOutCostsTheOthersNothing) {
  const Gaussians g = PlausibleGaussians(2000);
  g.sh[0] = 1e30f, g.log_scales[1] = -1e30f, g.sh[100] = 1e30f;
  const SplatDistance d =
      DistanceOf(Picked(g, {1, 2, 5}), Picked(DecodeSog(EncodeSog(g, 3), "x").gaussians, {1, 2, 5}));
  EXPECT_LE(d.color, 0.1f);
  EXPECT_LE(d.log_scales, 0.3f);
}

TEST(SogReader, ReadsAFolder) {
  const TempDir dir;
  for (const auto& [name, bytes] : ReadZip(EncodeSog(PlausibleGaussians(30), 1), 20, "x.sog")) {
    WriteFileAtomically(dir / name, bytes);
  }
  WriteFileAtomically(dir / "notes.txt", "mine");
  EXPECT_TRUE(IsSogFolder(dir.path()));
  const GaussianPly read = ReadSogFolder(dir.path());
  EXPECT_EQ(read.gaussians.size(), 30);
  EXPECT_EQ(read.sh_degree, 1);
  std::filesystem::remove(dir / "quats.webp");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadSogFolder(dir.path()); }), HasSubstr("has no file"));
  std::filesystem::remove(dir / "meta.json");
  EXPECT_FALSE(IsSogFolder(dir.path()));
}

TEST(SogReader, KeepsTheDegreeOfFewGaussians) {
  for (int degree = 0; degree <= 3; ++degree) {
    const GaussianPly read = DecodeSog(EncodeSog(PlausibleGaussians(3), degree), "x.sog");
    EXPECT_EQ(read.sh_degree, degree);
    EXPECT_EQ(read.gaussians.size(), 3);
  }
}

class DamagedSog : public testing::Test {
 protected:
  DamagedSog() : files_(ReadZip(EncodeSog(PlausibleGaussians(300), 1), 20, "x.sog")) {
    meta_ = nlohmann::json::parse(files_.at("meta.json"));
  }
  std::string Error() {
    std::vector<std::pair<std::string, std::string>> list;
    files_["meta.json"] = meta_.dump();
    for (const auto& [name, bytes] : files_) list.emplace_back(name, bytes);
    return DecodeError(DecodeSog, WriteZip(list));
  }

  std::map<std::string, std::string> files_;
  nlohmann::json meta_;
};

TEST_F(DamagedSog, DescriptionIsRefused) {
  const nlohmann::json good = meta_;
  const auto error = [&](const char* path, nlohmann::json value) {
    meta_ = good;
    meta_[nlohmann::json::json_pointer(path)] = std::move(value);
    return Error();
  };
  EXPECT_THAT(error("/version", 3), HasSubstr("is SOG of version 3, and only 2 can be read"));
  EXPECT_THAT(error("/count", -1), HasSubstr("'count'"));
  EXPECT_THAT(error("/count", 0), HasSubstr("holds no Gaussians"));
  EXPECT_THAT(error("/count", 1e6), HasSubstr("'count'"));
  EXPECT_THAT(error("/count", 100000), HasSubstr("for 100000 Gaussians"));
  EXPECT_THAT(error("/count", 200000000), HasSubstr("the file is damaged"));
  EXPECT_THAT(error("/means", 3), HasSubstr("'means.files'"));
  EXPECT_THAT(error("/means/mins", {1, 2}), HasSubstr("'means.mins' of 3 numbers"));
  EXPECT_THAT(error("/means/mins/0", nullptr), HasSubstr("'means.mins' of 3 numbers"));
  EXPECT_THAT(error("/means/maxs/0", 1e30), HasSubstr("is inf"));
  EXPECT_THAT(error("/scales/codebook", {1}), HasSubstr("'scales.codebook' of 256"));
  EXPECT_THAT(error("/sh0/files", "sh0.webp"), HasSubstr("'sh0.files'"));
  EXPECT_THAT(error("/quats/files/0", "../a\n.webp"), HasSubstr("has no file"));
  EXPECT_THAT(error("/shN/bands", 4), HasSubstr("'bands'"));
  EXPECT_THAT(error("/shN/bands", 2), HasSubstr("image of the harmonics"));
  EXPECT_THAT(error("/shN/count", 1), HasSubstr("harmonics of Gaussian"));
  EXPECT_THAT(error("/shN/count", 9999), HasSubstr("image of the harmonics"));
}

TEST_F(DamagedSog, FilesAreRefused) {
  const auto good = files_;
  files_["quats.webp"] = "no image";
  EXPECT_THAT(Error(), HasSubstr("is not a WebP image"));
  files_ = good;
  files_["quats.webp"] = EncodeWebp({4, 4, std::vector<uint8_t>(64, 255)});
  EXPECT_THAT(Error(), HasSubstr("4 x 4 pixels for 300 Gaussians"));
  files_["quats.webp"] = EncodeWebp({20, 20, std::vector<uint8_t>(1600, 9)});
  EXPECT_THAT(Error(), HasSubstr("rotation of Gaussian"));
  files_["quats.webp"] = EncodeWebp({1000, 1000, std::vector<uint8_t>(4000000, 255)});
  EXPECT_THAT(Error(), HasSubstr("many more than the splat has Gaussians"));
  EXPECT_THAT(DecodeError(DecodeSog, "ply"), HasSubstr("is not a zip archive"));
  EXPECT_THAT(DecodeError(DecodeSog, WriteZip({{"a.txt", ""}})), HasSubstr("has no meta.json"));
  EXPECT_THAT(DecodeError(DecodeSog, WriteZip({{"meta.json", "["}})), HasSubstr("meta.json"));
}

}  // namespace
}  // namespace oraclegs
