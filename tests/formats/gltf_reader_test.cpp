#include "oraclegs/formats/codecs.h"

#include <nlohmann/json.hpp>

#include "formats/glb_edit.h"
#include "formats/splats.h"
#include "oraclegs/formats/linear_colors.h"
#include "support/allocations.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(GltfReader, RoundTripsButForRounding) {
  for (int degree = 0; degree <= 3; ++degree) {
    Gaussians g = HostCopy(PlausibleGaussians(200), degree);
    const GaussianPly read = DecodeGltf(EncodeGltf(g, degree), "x.glb");
    EXPECT_EQ(read.sh_degree, degree);
    const SplatDistance d = DistanceOf(g, read.gaussians);
    EXPECT_EQ(d.means, 0);
    EXPECT_LE(d.log_scales, 1e-5f);
    EXPECT_LE(d.rotation, 1e-6f);
    EXPECT_LE(d.opacity, 1e-6f);
    EXPECT_EQ(d.color, 0);
    EXPECT_EQ(d.higher_degrees, 0);
  }
}

TEST(GltfReader, ReadsSpz) {
  const Gaussians g = PlausibleGaussians(200);
  const GaussianPly read = DecodeGltf(EncodeGltfSpz(g, 2), "x.glb");
  EXPECT_EQ(read.sh_degree, 2);
  EXPECT_LE(DistanceOf(HostCopy(g, 2), read.gaussians).means, 0.001f);
}

TEST(GltfReader, PutsGaussiansWhereTheirNodesAre) {
  Gaussians g = PlausibleGaussians(1);
  const std::string moved = EditGlb(EncodeGltf(g, 0), [](nlohmann::json& json) {
    json["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}}, {{"mesh", 0}, {"scale", {2, 2, 2}}}};
  });
  const GaussianPly read = DecodeGltf(moved, "x.glb");
  EXPECT_NEAR(read.gaussians.means[0], 2 * g.means[0] - 10, 1e-5);  // glTF's x is the program's -x
  EXPECT_NEAR(read.gaussians.log_scales[0], g.log_scales[0] + std::log(2.f), 1e-5);
}

TEST(GltfReader, JoinsPrimitives) {
  const std::string twice = EditGlb(EncodeGltf(PlausibleGaussians(7), 1), [](nlohmann::json& json) {
    nlohmann::json& primitives = json["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
  });
  EXPECT_EQ(DecodeGltf(twice, "x.glb").gaussians.size(), 14);
}

TEST(GltfReader, RefusesDamagedFiles) {
  const std::string good = EncodeGltf(PlausibleGaussians(7), 1);
  const auto error = [&](const char* path, nlohmann::json value) {
    return DecodeError(DecodeGltf, EditGlb(good, [&](nlohmann::json& json) {
                         json[nlohmann::json::json_pointer(path)] = std::move(value);
                       }));
  };
  const std::string primitive = "/meshes/0/primitives/0/";
  EXPECT_THAT(error("/scene", 3), HasSubstr("no item 3 in 'scenes'"));
  EXPECT_THAT(error("/scenes/0/nodes", {9}), HasSubstr("no item 9 in 'nodes'"));
  EXPECT_THAT(error("/scenes/0/nodes", {0, 0}), HasSubstr("node 0 stands at two places"));
  EXPECT_THAT(error("/nodes/0/children", {0}), HasSubstr("node 0 stands at two places"));
  EXPECT_THAT(error("/nodes/0/scale", {1, 2, 1}), HasSubstr("scales them unevenly"));
  EXPECT_THAT(error("/nodes/0/scale", {-1, 1, 1}), HasSubstr("mirrors"));
  EXPECT_THAT(error("/nodes/0/matrix", {1, 2}), HasSubstr("'matrix'"));
  EXPECT_THAT(error("/meshes/0/primitives", 1), HasSubstr("no node of its scene has Gaussians"));
  EXPECT_THAT(error((primitive + "attributes").c_str(), nullptr), HasSubstr("no attributes"));
  EXPECT_THAT(error((primitive + "attributes/POSITION").c_str(), 99), HasSubstr("no item 99 in 'accessors'"));
  EXPECT_THAT(error((primitive + "attributes/POSITION").c_str(), "x"), HasSubstr("'POSITION' is no valid number"));
  EXPECT_THAT(error("/accessors/0/count", 8), HasSubstr("promises 8 items"));
  EXPECT_THAT(error("/accessors/0/count", 1099511627776), HasSubstr("promises 1099511627776 items"));
  EXPECT_THAT(error("/accessors/0/count", 6), HasSubstr("is not of 6 Gaussians"));
  EXPECT_THAT(error("/accessors/0/type", "VEC4"), HasSubstr("promises 7 items"));
  EXPECT_THAT(error("/accessors/0/type", "VEC2"), HasSubstr("2 numbers an item, expected 3"));
  EXPECT_THAT(error("/accessors/0/sparse", {{"count", 1}}), HasSubstr("sparse"));
}

TEST(GltfReader, RefusesAnSpzBomb) {
  const std::string bomb = EncodeGltfSpz(Gaussians::Zeros(300000), 0);
  EXPECT_THAT(DecodeError(DecodeGltf, bomb), HasSubstr("promises 300000 Gaussians in"));
}

TEST(GltfReader, RefusesAMeshOfGaussiansAtTwoNodes) {
  const auto with_two_nodes = [](int mesh) {
    return EditGlb(EncodeGltf(PlausibleGaussians(7), 0), [&](nlohmann::json& json) {
      json["meshes"].push_back({{"primitives", {{{"attributes", nlohmann::json::object()}}}}});
      json["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}}, {{"mesh", mesh}}, {{"mesh", mesh}}};
    });
  };
  EXPECT_THAT(DecodeError(DecodeGltf, with_two_nodes(0)), HasSubstr("mesh 0 of Gaussians stands at two nodes"));
  EXPECT_EQ(DecodeGltf(with_two_nodes(1), "x.glb").gaussians.size(), 7);  // no Gaussians are in that one
}

TEST(GltfReader, RefusesPrimitivesThatShareBytesWithoutEnd) {
  const auto repeated = [](const std::string& glb, int times) {
    return EditGlb(glb, [&](nlohmann::json& json) {
      const nlohmann::json first = json["meshes"][0]["primitives"][0];
      for (int i = 1; i < times; ++i) json["meshes"][0]["primitives"].push_back(first);
    });
  };
  const std::string rows = EncodeGltf(PlausibleGaussians(2000), 0);
  EXPECT_EQ(DecodeGltf(repeated(rows, 4), "x.glb").gaussians.size(), 8000);
  EXPECT_THAT(DecodeError(DecodeGltf, repeated(rows, 40)), HasSubstr("66000 Gaussians or more"));
  const std::string packed = EncodeGltfSpz(Gaussians::Zeros(100000), 0);
  EXPECT_THAT(DecodeError(DecodeGltf, repeated(packed, 40)),
              HasSubstr("00000 Gaussians or more, which its bytes cannot hold"));
}

TEST(GltfReader, ConvertsLinearColors) {
  const Gaussians g = PlausibleGaussians(7);
  const auto of_space = [&](nlohmann::json space) {
    return DecodeGltf(
        EditGlb(EncodeGltf(g, 1),
                [&](nlohmann::json& json) {
                  json["meshes"][0]["primitives"][0]["extensions"]["KHR_gaussian_splatting"]["colorSpace"] =
                      std::move(space);
                }),
        "x.glb");
  };
  const GaussianPly linear = of_space("lin_rec709_display"), other = of_space("acescg");
  Gaussians expected = HostCopy(g, 1);
  ColorsFromLinear(1, &expected);
  EXPECT_LE(DistanceOf(expected, linear.gaussians).color, 1e-5f);
  EXPECT_GT(DistanceOf(g, linear.gaussians).color, 0.05f);
  EXPECT_THAT(linear.warnings, testing::ElementsAre(HasSubstr("linear")));
  EXPECT_EQ(DistanceOf(g, other.gaussians).color, 0);
  EXPECT_THAT(other.warnings, testing::ElementsAre(HasSubstr("acescg")));
  EXPECT_TRUE(of_space("srgb_rec709_display").warnings.empty());
}

TEST(GltfReader, SaysThatAFourthDegreeIsLeftOut) {
  const std::string more = EditGlb(EncodeGltf(PlausibleGaussians(7), 3), [](nlohmann::json& json) {
    nlohmann::json& attributes = json["meshes"][0]["primitives"][0]["attributes"];
    attributes["KHR_gaussian_splatting:SH_DEGREE_4_COEF_0"] = attributes["POSITION"];
  });
  EXPECT_THAT(DecodeGltf(more, "x.glb").warnings, testing::ElementsAre(HasSubstr("degree 4")));
}

TEST(GltfReader, RefusesWhatANodeMakesInfinite) {
  const std::string huge = EditGlb(EncodeGltf(PlausibleGaussians(7), 0), [](nlohmann::json& json) {
    json["nodes"][0]["scale"] = {1e40, 1e40, 1e40};
  });
  EXPECT_THAT(DecodeError(DecodeGltf, huge), HasSubstr("numbers that are not finite"));
}

TEST(GltfReader, NamingANodeAgainAndAgainCostsNothing) {
  const std::string named = EditGlb(EncodeGltf(PlausibleGaussians(7), 0), [](nlohmann::json& json) {
    json["scenes"][0]["nodes"] = std::vector<int>(1'000'000, 0);
  });
  AllocationCounter::Begin();
  EXPECT_THAT(DecodeError(DecodeGltf, named), HasSubstr("node 0 stands at two places"));
  AllocationCounter::End();
  EXPECT_LT(AllocationCounter::Bytes(), 80'000'000);
}

TEST(GltfReader, RefusesNumbersThatAreNotFinite) {
  std::string bytes = EncodeGltf(PlausibleGaussians(7), 0);
  const size_t bin = bytes.find("BIN") + 4;
  StoreLittle(bytes.data() + bin, std::nanf(""));
  EXPECT_THAT(DecodeError(DecodeGltf, bytes), HasSubstr("x of Gaussian 0"));
}

}  // namespace
}  // namespace oraclegs
