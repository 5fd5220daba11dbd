#include "oraclegs/formats/codecs.h"

#include <nlohmann/json.hpp>

#include "formats/splats.h"
#include "oraclegs/formats/webp.h"
#include "oraclegs/formats/zip_archive.h"

namespace oraclegs {
namespace {

TEST(SogWriter, HasTheLayoutOfTheFormat) {
  Gaussians g = PlausibleGaussians(1000);
  const auto files = ReadZip(EncodeSog(g, 2), 20, "x.sog");
  const nlohmann::json meta = nlohmann::json::parse(files.at("meta.json"));
  EXPECT_EQ(meta["version"], 2);
  EXPECT_EQ(meta["count"], 1000);
  EXPECT_EQ(meta["scales"]["codebook"].size(), 256u);
  EXPECT_EQ(meta["shN"]["bands"], 2);
  const int sets = meta["shN"]["count"];
  EXPECT_GT(sets, 60);
  EXPECT_LE(sets, 125);
  for (const char* name :
       {"means_l.webp", "means_u.webp", "quats.webp", "scales.webp", "sh0.webp", "shN_labels.webp"}) {
    const ByteImage image = DecodeWebp(files.at(name), 1 << 20, name);
    EXPECT_EQ(image.width, 32) << name;
    EXPECT_EQ(image.height, 32) << name;
  }
  const ByteImage sets_image = DecodeWebp(files.at("shN_centroids.webp"), 1 << 20, "shN");
  EXPECT_EQ(sets_image.width, 64 * 8);
  EXPECT_EQ(sets_image.height, (sets + 63) / 64);
  EXPECT_GE(DecodeWebp(files.at("quats.webp"), 1 << 20, "quats").rgba[3], 252);
}

TEST(SogWriter, NamesAModelThatWasTrainedAntialiased) {
  const auto model = [](bool antialiased) {
    const auto files = ReadZip(EncodeSog(PlausibleGaussians(10), 0, {}, antialiased), 20, "x.sog");
    return nlohmann::json::parse(files.at("meta.json")).value("model", "none");
  };
  EXPECT_EQ(model(true), "antialiased");
  EXPECT_EQ(model(false), "none");
}

TEST(SogWriter, LeavesOutWhatIsNotThere) {
  const Gaussians g = PlausibleGaussians(10);
  const auto plain = ReadZip(EncodeSog(g, 0), 20, "x.sog");
  EXPECT_EQ(plain.count("shN_labels.webp"), 0u);
  EXPECT_EQ(plain.count("support.webp"), 0u);
  EXPECT_EQ(ReadZip(EncodeSog(g, 0, std::vector<float>(10, 0.5f)), 20, "x.sog").count("support.webp"), 1u);
}

TEST(SogWriter, WritesTheSameBytesEveryTime) {
  const Gaussians g = PlausibleGaussians(500);
  EXPECT_EQ(EncodeSog(g, 3), EncodeSog(g, 3));
}

}  // namespace
}  // namespace oraclegs
