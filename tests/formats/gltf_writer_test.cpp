#include "oraclegs/formats/codecs.h"

#include "formats/splats.h"
#include "oraclegs/formats/glb_file.h"

namespace oraclegs {
namespace {

TEST(GltfWriter, HasTheAttributesOfTheExtension) {
  Gaussians g = PlausibleGaussians(5);
  const std::string bytes = EncodeGltf(g, 1, std::vector<float>(5, 0.75f));
  const GlbFile glb(bytes, "x.glb");
  const nlohmann::json& primitive = glb.json()["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 0);
  EXPECT_EQ(primitive["extensions"]["KHR_gaussian_splatting"]["kernel"], "ellipse");
  EXPECT_EQ(glb.json()["extensionsUsed"][0], "KHR_gaussian_splatting");
  const nlohmann::json& attributes = primitive["attributes"];
  EXPECT_EQ(attributes.size(), 4u + 4 + 2);
  EXPECT_TRUE(attributes.contains("KHR_gaussian_splatting:SH_DEGREE_1_COEF_2"));
  EXPECT_FALSE(attributes.contains("KHR_gaussian_splatting:SH_DEGREE_2_COEF_0"));
  const std::vector<float> scales = glb.Floats(attributes["KHR_gaussian_splatting:SCALE"], 3);
  EXPECT_FLOAT_EQ(scales[4], std::exp(g.log_scales[4]));  // linear
  EXPECT_FLOAT_EQ(glb.Floats(attributes["KHR_gaussian_splatting:OPACITY"], 1)[2], Sigmoid(g.opacity_logits[2]));
  EXPECT_EQ(glb.Floats(attributes["_SUPPORT"], 1)[4], 0.75f);
  const std::vector<float> means = glb.Floats(attributes["POSITION"], 3);
  EXPECT_EQ(means[0], -g.means[0]);  // x to the left, y up
  EXPECT_EQ(means[1], -g.means[1]);
  EXPECT_EQ(means[2], g.means[2]);
  const nlohmann::json& position = glb.json()["accessors"][static_cast<int>(attributes["POSITION"])];
  EXPECT_EQ(position["min"][0].get<float>(), (-Table(g.means).col(0)).minCoeff());
}

TEST(GltfWriter, WithSpzNeedsItsReader) {
  const std::string bytes = EncodeGltfSpz(PlausibleGaussians(50), 3);
  const GlbFile glb(bytes, "x.glb");
  EXPECT_EQ(glb.json()["extensionsRequired"].size(), 2u);
  EXPECT_LT(bytes.size(), EncodeGltf(PlausibleGaussians(50), 3).size());
  EXPECT_FALSE(glb.json()["accessors"][0].contains("bufferView"));
}

}  // namespace
}  // namespace oraclegs
