#include <Eigen/Geometry>

#include "formats/splats.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/formats/linear_colors.h"
#include "oraclegs/formats/zip_archive.h"
#include "oraclegs/gaussians/transform.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(UsdReader, RoundTripsButForRounding) {
  for (int degree = 0; degree <= 3; ++degree) {
    const Gaussians g = HostCopy(PlausibleGaussians(5000), degree);
    for (const bool packed : {false, true}) {
      const GaussianPly read =
          packed ? DecodeUsdz(EncodeUsdz(g, degree), "x.usdz") : DecodeUsda(EncodeUsda(g, degree), "x.usda");
      EXPECT_EQ(read.sh_degree, degree);
      EXPECT_TRUE(read.warnings.empty());
      EXPECT_TRUE(read.comments.empty());
      const SplatDistance d = DistanceOf(g, read.gaussians);
      EXPECT_EQ(d.means, 0);
      EXPECT_LE(d.log_scales, 1e-5f);
      EXPECT_LE(d.rotation, 1e-6f);
      EXPECT_LE(d.opacity, 1e-6f);
      EXPECT_EQ(d.color + d.first_degree + d.higher_degrees, 0);
    }
  }
}

constexpr const char* kOneGaussian = R"(
    point3f[] positions = [(1, 2, 3)]
    quatf[] orientations = [(1, 0, 0, 0)]
    float3[] scales = [(1, 1, 1)]
    float[] opacities = [0.5]
    uniform int radiance:sphericalHarmonicsDegree = 0
    float3[] radiance:sphericalHarmonicsCoefficients = [(1, 2, 3)]
)";

std::string UsdOf(const std::string& body, const std::string& metadata = "") {
  return "#usda 1.0\n(" + metadata + ")\n" + body;
}

std::string PrimOf(const std::string& body, const std::string& metadata = "") {
  return "def ParticleField3DGaussianSplat \"A\"" + (metadata.empty() ? "" : " (" + metadata + ")") + "\n{" + body +
         "}\n";
}

std::vector<float> Means(const std::string& usda) {
  const Gaussians g = DecodeUsda(usda, "x").gaussians;
  return {g.means.span().begin(), g.means.span().end()};
}

std::string Error(const std::string& usda) { return DecodeError(DecodeUsda, usda); }

/// The Gaussian of kOneGaussian with a line of another text.
std::string ErrorWith(const std::string& line, const std::string& other) {
  std::string body = kOneGaussian;
  const size_t at = body.find(line);
  EXPECT_NE(at, std::string::npos);
  return Error(UsdOf(PrimOf(body.replace(at, line.size(), other))));
}

TEST(UsdReader, ReadsFilesOfOtherPrograms) {
  const GaussianPly read = DecodeUsda(R"(#usda 1.0
(
    "a note"
    doc = """it's "long"
    """
    customLayerData = { dictionary a = { string references = "@x@" } }
    defaultPrim = "World"
    metersPerUnit = 0.01
    subLayers = []
    upAxis = "Y"
)

def Xform "World" (
    prepend references = None
    kind = "component"
) {
    custom string note = "def"; float[] xs = [1, 2] (elementSize = 2)
    token outputs:out
    rel target = </World/Looks>
    prepend rel other = [</A>, </B>]
    float moving.timeSamples = { 0: 1, 1: 2, }
    token connected.connect = </World.note>
    reorder nameChildren = ["Splat", "Looks"]
    def Material "Looks" { asset file = @ParticleFieldEmissive.mdl@ (customData = { bool b = 1 }) }
    def ParticleField3DGaussianSplat "Splat" (
        prepend apiSchemas = ["ColorSpaceAPI", 'MaterialBindingAPI']
    ) {
        point3h[] positionsh = [(9, 9, 9), (8, 8, 8)]  # floats go first
        point3f[] positions = [(1, 2, 3)] (
            interpolation = "vertex"
        )
        quath[] orientationsh = [(1, 0, 0, 0)]
        half3[] scalesh = [(1, 2, 3)]
        half[] opacitiesh = [0.5]
        uniform int radiance:sphericalHarmonicsDegree = 0
        half3[] radiance:sphericalHarmonicsCoefficientsh = [(1, 2, 3)]
    }
}
)",
                                      "x");
  ASSERT_EQ(read.gaussians.size(), 1);
  EXPECT_THAT(read.comments, ElementsAre("a unit is 0.01 m"));
  EXPECT_TRUE(read.warnings.empty());
  const GaussianRows g = read.gaussians.Rows();
  EXPECT_EQ(g.means[0], 1);
  EXPECT_EQ(g.means[1], -2) << "y points up in the file";
  EXPECT_EQ(g.means[2], -3);
  EXPECT_NEAR(g.log_scales[2], std::log(3.f), 1e-6);
  EXPECT_EQ(g.opacity_logits[0], 0);
  EXPECT_EQ(g.sh[2], 3);
}

TEST(UsdReader, PutsPrimsWhereThePrimsAboveThemSay) {
  const std::string moved = "double3 xformOp:translate = (10, 0, 0)\ntoken[] xformOpOrder = [\"xformOp:translate\"]\n";
  EXPECT_THAT(Means(UsdOf("def \"W\" {\n" + moved + PrimOf(kOneGaussian + moved) + "}\n" + PrimOf(kOneGaussian))),
              ElementsAre(21, -2, -3, 1, -2, -3));
  // The transform may stand behind the prims that it moves.
  EXPECT_THAT(Means(UsdOf("def \"W\" {\n" + PrimOf(kOneGaussian) + moved + "}\n")), ElementsAre(11, -2, -3));
  const std::string reset =
      "double3 xformOp:translate = (0, 5, 0)\n"
      "token[] xformOpOrder = [\"!resetXformStack!\", \"xformOp:translate\"]\n";
  EXPECT_THAT(Means(UsdOf("def \"W\" {\n" + moved + PrimOf(kOneGaussian + reset) + "}\n")), ElementsAre(1, -7, -3));
  const std::string uneven = "double3 xformOp:scale = (1, 1, 2)\ntoken[] xformOpOrder = [\"xformOp:scale\"]\n";
  EXPECT_THAT(Error(UsdOf(PrimOf(kOneGaussian + uneven))), HasSubstr("x: prim \"A\" mirrors its Gaussians or scales"));
}

TEST(UsdReader, TurnsAStageWhoseUpIsZ) {
  const Gaussians g = PlausibleGaussians(30);
  std::string text = EncodeUsda(g, 3);
  text.replace(text.find("upAxis = \"Y\""), 12, "upAxis = \"Z\"");
  // z of the file is up: -y here; y of the file is away from the viewer: z here, where SPZ's axes have -z.
  Similarity turn;
  turn.rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  EXPECT_LE(DistanceOf(Transformed(g, turn), DecodeUsda(text, "x").gaussians).means, 1e-6f);
  EXPECT_LE(DistanceOf(Transformed(g, turn), DecodeUsda(text, "x").gaussians).higher_degrees, 1e-5f);
  EXPECT_THAT(Means(UsdOf(PrimOf(kOneGaussian), "upAxis = 'Z'")), ElementsAre(1, -3, 2));
}

TEST(UsdReader, PassesOverWhatIsNotDrawn) {
  const std::string one = PrimOf(kOneGaussian);
  EXPECT_EQ(Means(UsdOf("class \"C\" {" + one + "}\nover \"O\" {" + one + "}\n" +
                        PrimOf(kOneGaussian, "active = false") + PrimOf(kOneGaussian, "active = true")))
                .size(),
            3u);
}

TEST(UsdReader, ConvertsLinearColorsOfThePrimOrOneAbove) {
  const Gaussians g = PlausibleGaussians(7);
  const std::string srgb = EncodeUsda(g, 1);
  const auto of_space = [&](const std::string& space) {
    std::string text = srgb;
    const std::string name = "\"srgb_rec709_scene\"";
    return DecodeUsda(text.replace(text.find(name), name.size(), "\"" + space + "\""), "x");
  };
  Gaussians expected = HostCopy(g, 1);
  ColorsFromLinear(1, &expected);
  EXPECT_LE(DistanceOf(expected, of_space("lin_rec709_scene").gaussians).color, 1e-5f);
  EXPECT_THAT(of_space("lin_rec709_scene").warnings, ElementsAre(HasSubstr("linear")));
  EXPECT_EQ(DistanceOf(g, of_space("lin_ap1_scene").gaussians).color, 0);
  EXPECT_THAT(of_space("lin_ap1_scene").warnings, ElementsAre(HasSubstr("\"lin_ap1_scene\", which is not known")));
  EXPECT_TRUE(of_space("srgb_rec709_display").warnings.empty());
  EXPECT_TRUE(DecodeUsda(UsdOf(PrimOf(kOneGaussian)), "x").warnings.empty());
  const std::string above = "def \"W\" { uniform token colorSpace:name = \"lin_rec709_scene\"\n";
  EXPECT_EQ(DecodeUsda(UsdOf(above + PrimOf(kOneGaussian) + "}"), "x").warnings.size(), 1u);
}

TEST(UsdReader, RefusesWhatLiesElsewhere) {
  const std::string fix = " bring in prims from elsewhere and are not read; write it as one file with usdcat --flatten";
  for (const char* arc :
       {"prepend references = @./a.usda@</A>", "payload = [@a.usda@]", "inherits = </C>", "add specializes = </C>",
        "variants = { string a = \"b\" }", "prepend variantSets = \"a\"", "clips = { }"}) {
    EXPECT_THAT(Error(UsdOf(PrimOf(kOneGaussian, arc))), HasSubstr(fix)) << arc;
  }
  EXPECT_THAT(Error(UsdOf(PrimOf(kOneGaussian), "subLayers = [@a.usda@]")), HasSubstr("x: has subLayers, which" + fix));
  EXPECT_THAT(Error(UsdOf(PrimOf("variantSet \"a\" = { \"b\" { } }"))), HasSubstr("has variant sets"));
}

TEST(UsdReader, RefusesDamagedGaussians) {
  EXPECT_THAT(Error(UsdOf("")), HasSubstr("x: has no prim of the type ParticleField3DGaussianSplat"));
  EXPECT_THAT(ErrorWith("[(1, 0, 0, 0)]", "[]"), HasSubstr("prim \"A\" has 0 numbers of orientations for 1 Gaussians"));
  EXPECT_THAT(ErrorWith("[0.5]", "[0.5, 0.5]"), HasSubstr("2 numbers of opacities for 1 Gaussians, expected 1"));
  EXPECT_THAT(ErrorWith("[(1, 1, 1)]", "[]"), HasSubstr("0 numbers of scales for 1 Gaussians, expected 3"));
  EXPECT_THAT(ErrorWith("Degree = 0", "Degree = 1"), HasSubstr("for 1 Gaussians, expected 12"));
  EXPECT_THAT(ErrorWith("Degree = 0", "Degree = 0.5"), HasSubstr("Degree = 0.5, expected 0 to 3"));
  EXPECT_THAT(ErrorWith("Degree = 0", "Degree = -1"), HasSubstr("Degree = -1, expected 0 to 3"));
  EXPECT_THAT(ErrorWith("Degree = 0", "Degree = 1e30"), HasSubstr("expected 0 to 3"));
  EXPECT_THAT(ErrorWith("positions = [(1, 2, 3)]", "positions = []"), HasSubstr("4 numbers of orientations for 0"));
  EXPECT_THAT(Error(UsdOf(PrimOf("point3f[] positions = []\nquatf[] orientations = []\nfloat3[] scales = []\n"
                                 "float[] opacities = []\nfloat3[] radiance:sphericalHarmonicsCoefficients = []\n"))),
              HasSubstr("holds no Gaussians"));
  EXPECT_THAT(ErrorWith("positions = ", "points = "), HasSubstr("prim \"A\" has no positions; export it again"));
  EXPECT_THAT(ErrorWith("positions = ", "positions.timeSamples = "), HasSubstr("moves in time or is connected"));
  EXPECT_THAT(ErrorWith("float3[] scales", "point3f[] positions"), HasSubstr("\"positions\" stands there twice"));
  EXPECT_THAT(ErrorWith("(1, 2, 3)", "(nan, 2, 3)"), HasSubstr("x: "));
}

TEST(UsdReader, RefusesDamagedText) {
  EXPECT_THAT(Error(UsdOf("def \"A\" {")), HasSubstr("x:3: the text ends within prim \"A\""));
  EXPECT_THAT(Error(UsdOf("}")), HasSubstr("'}' stands where a name was expected"));
  EXPECT_THAT(Error(UsdOf("def \"A\"")), HasSubstr("prim \"A\" has no body"));
  EXPECT_THAT(Error(UsdOf("(")), HasSubstr("metadata stands behind nothing"));
  EXPECT_THAT(Error("#usda 1.0\n("), HasSubstr("the text ends within metadata"));
  EXPECT_THAT(Error(UsdOf("def \"A\" { int a (")), HasSubstr("the text ends within metadata"));
  EXPECT_THAT(Error(UsdOf("", "upAxis = 'X'")), HasSubstr("upAxis is \"X\", expected Y or Z"));
  EXPECT_THAT(Error(UsdOf("", "metersPerUnit = 0")), HasSubstr("metersPerUnit is 0, expected a number above 0"));
  EXPECT_THAT(Error(UsdOf("", "metersPerUnit = []")), HasSubstr("metersPerUnit is no number"));
  EXPECT_THAT(ErrorWith("Degree = 0", "Degree = []"), HasSubstr("is no number"));
  std::string many;
  for (int i = 0; i <= 100000; ++i) many += "def\"\"{}";
  EXPECT_THAT(Error(UsdOf(many)), HasSubstr("has more than 100000 prims"));
}

TEST(UsdReader, ReadsDegreesToThree) {
  std::string harmonics = "radiance:sphericalHarmonicsDegree = 4\nfloat3[] radiance:sphericalHarmonicsCoefficients = [";
  for (int k = 0; k < 25; ++k) harmonics += fmt::format("({}, 0, 0),", k);
  std::string body = kOneGaussian;
  body = body.substr(0, body.find("uniform int")) + "uniform int " + harmonics + "]\n";
  const GaussianPly read = DecodeUsda(UsdOf(PrimOf(body)), "x");
  EXPECT_EQ(read.sh_degree, 3);
  EXPECT_EQ(std::abs(read.gaussians.sh[45]), 15);
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("degree 4")));
}

TEST(UsdReader, RefusesArchivesWithoutOneLayer) {
  const std::string layer = EncodeUsda(PlausibleGaussians(2), 0);
  EXPECT_EQ(DecodeUsdz(WriteZip({{"a.png", "x"}, {"a.usd", layer}}), "x").gaussians.size(), 2);
  EXPECT_THAT(DecodeError(DecodeUsdz, WriteZip({{"a.png", "x"}})), HasSubstr("holds no file of USD"));
  EXPECT_THAT(DecodeError(DecodeUsdz, WriteZip({{"a.usda", layer}, {"b.usda", layer}})),
              HasSubstr("has several layers"));
  EXPECT_THAT(DecodeError(DecodeUsdz, WriteZip({{"a.usdc", "PXR-USDC"}})), HasSubstr("is USD's binary format"));
  EXPECT_THAT(DecodeError(DecodeUsdz, layer), HasSubstr("is not a zip archive"));
}

}  // namespace
}  // namespace oraclegs
