#include "formats/splats.h"
#include "oraclegs/formats/codecs.h"

namespace oraclegs {
namespace {

TEST(UsdWriter, HasTheNamesAndUnitsOfTheSchema) {
  Gaussians g = Gaussians::Zeros(2);
  g.means[1] = 2;  // down
  g.quats[0] = 2, g.quats[4] = g.quats[5] = 1;
  g.log_scales[0] = std::log(0.5f);
  g.opacity_logits[1] = 15;
  g.sh[2] = 0.25f, g.sh[3] = 1;  // blue; red along y
  EXPECT_EQ(EncodeUsda(g, 1, 0.01), R"(#usda 1.0
(
    customLayerData = {
        string creator = "oraclegs"
    }
    defaultPrim = "Splat"
    metersPerUnit = 0.01
    upAxis = "Y"
)

def ParticleField3DGaussianSplat "Splat" (
    prepend apiSchemas = ["ColorSpaceAPI"]
)
{
    uniform token colorSpace:name = "srgb_rec709_scene"
    uniform token projectionModeHint = "perspective"
    uniform token sortingModeHint = "zDepth"
    float3[] extent = [(-3,-5,-3), (3,3,3)]
    point3f[] positions = [
(0,-2,0),
(0,0,0)
    ]
    quatf[] orientations = [
(1,0,0,0),
(0.70710677,0.70710677,0,0)
    ]
    float3[] scales = [
(0.5,1,1),
(1,1,1)
    ]
    float[] opacities = [
0.5,
0.99999964
    ]
    uniform int radiance:sphericalHarmonicsDegree = 1
    float3[] radiance:sphericalHarmonicsCoefficients = [
(0,0,0.25),(-1,0,0),(0,0,0),(0,0,0),
(0,0,0),(0,0,0),(0,0,0),(0,0,0)
    ]
}
)");
}

TEST(UsdWriter, LetsTheTextOfAnArchiveBeginAt64Bytes) {
  const Gaussians g = PlausibleGaussians(3);
  const std::string archive = EncodeUsdz(g, 0, 2), text = EncodeUsda(g, 0, 2);
  EXPECT_EQ(archive.find(text), 64u) << "the first file, stored as it is";
  EXPECT_EQ(archive.substr(30, 10), "splat.usda");
}

TEST(UsdWriter, WritesTheSameBytesEveryTime) {
  const Gaussians g = PlausibleGaussians(10000);
  EXPECT_EQ(EncodeUsdz(g, 1), EncodeUsdz(g, 1));
}

}  // namespace
}  // namespace oraclegs
