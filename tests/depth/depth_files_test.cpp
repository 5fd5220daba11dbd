#include "oraclegs/depth/depth_files.h"

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "depth/surfaces.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const Camera kCamera = CameraAt({0, 0.2, -4}, {0, 0, 0}, 24, 18);

/// A map in which pixels 0 to 19 are unknown, with growing confidence.
DepthMap MapNamed(const std::string& name) {
  DepthMap map = TrueDepth(kSlanted.Take(kCamera, name), kSlanted, 1);
  for (size_t i = 0; i < map.size(); ++i) {
    map.confidence[i] = static_cast<float>(i) / static_cast<float>(map.size() - 1);
    if (i >= 20) continue;
    map.confidence[i] = map.inv_depth[i] = 0;
    map.normals[i].setZero();
  }
  return map;
}

class DepthFilesTest : public testing::Test {
 protected:
  void SetUp() override { WriteDepthMaps(dir_.path(), {MapNamed("a.jpg")}); }

  std::vector<DepthMap> Read() const { return ReadDepthMaps(dir_.path(), {"a.jpg"}, {kCamera}); }
  std::string Error() const {
    try {
      Read();
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  void Put(const std::string& file, const std::string& bytes) const { WriteFileAtomically(dir_ / file, bytes); }
  void Cut(const std::string& file) const {
    const std::string bytes = ReadFile(dir_ / file);
    Put(file, bytes.substr(0, bytes.size() / 2));
  }

  TempDir dir_;
};

TEST_F(DepthFilesTest, RoundTripWithinQuantization) {
  const DepthMap map = MapNamed("a.jpg"), read = Read().at(0);
  EXPECT_EQ(read.name, "a.jpg");
  EXPECT_EQ(read.camera.fx, kCamera.fx);
  ASSERT_EQ(read.size(), map.size());
  ASSERT_EQ(read.normals.size(), map.size());
  const float step = *std::max_element(map.inv_depth.begin(), map.inv_depth.end()) / 65535;
  for (size_t i = 0; i < map.size(); ++i) {
    EXPECT_NEAR(read.inv_depth[i], map.inv_depth[i], 0.52f * step);
    EXPECT_NEAR(read.confidence[i], map.confidence[i], 0.51f / 255);
    EXPECT_EQ(read.inv_depth[i] > 0, map.inv_depth[i] > 0);
    if (read.confidence[i] > 0) {
      EXPECT_GT(read.normals[i].dot(map.normals[i]), 0.9999f);
      EXPECT_NEAR(read.normals[i].norm(), 1, 1e-5);
    } else {
      EXPECT_EQ(read.normals[i], Eigen::Vector3f(0, 0, 0));
    }
  }
}

TEST_F(DepthFilesTest, KeepMonocularFlag) {
  DepthMap filled = MapNamed("b.jpg");
  filled.monocular = true;
  WriteDepthMaps(dir_.path(), {MapNamed("a.jpg"), filled});
  const std::vector<DepthMap> read = ReadDepthMaps(dir_.path(), {"a.jpg", "b.jpg"}, {kCamera, kCamera});
  EXPECT_FALSE(read[0].monocular);
  EXPECT_TRUE(read[1].monocular);
}

TEST_F(DepthFilesTest, WriteListedFiles) {
  const TempDir dir;
  const std::vector<std::string> files = WriteDepthMaps(dir.path(), {MapNamed("a/b.jpg"), MapNamed("c.png")});
  EXPECT_THAT(files, testing::UnorderedElementsAre("a_b.png", "confidence/a_b.png", "normals/a_b.png",
                                                   "preview/a_b.jpg", "c.png", "confidence/c.png", "normals/c.png",
                                                   "preview/c.jpg", "depth_params.json"));
  for (const std::string& file : files) EXPECT_TRUE(fs::is_regular_file(dir / file)) << file;
  const Image8 preview = ReadImage(dir / "preview/a_b.jpg");
  EXPECT_EQ(preview.width, 48);
  EXPECT_EQ(preview.height, 18);
}

TEST_F(DepthFilesTest, MatchDepthParamsFormat) {
  const DepthMap map = MapNamed("a.jpg");
  const nlohmann::json params = nlohmann::json::parse(ReadFile(dir_ / "depth_params.json"));
  const double scale = params.at("a").at("scale"), offset = params.at("a").at("offset");
  const Image16 image = ReadPng16(dir_ / "a.png");
  for (size_t i = 0; i < map.size(); i += 31) {
    EXPECT_NEAR(image.values[i] / 65535.0 * scale + offset, map.inv_depth[i], 1e-5);
  }
}

TEST_F(DepthFilesTest, KeepCollidingNamesApart) {
  const TempDir dir;
  const std::vector<std::string> names = {"a/b.jpg", "a_b.png", "a_b_1.png", "a_b_0_0.png", "c.jpg"};
  std::vector<DepthMap> maps;
  for (size_t v = 0; v < names.size(); ++v) {
    maps.push_back(MapNamed(names[v]));
    maps[v].inv_depth.assign(maps[v].size(), static_cast<float>(v + 1));
    maps[v].confidence.assign(maps[v].size(), 1);
  }
  const std::vector<std::string> files = WriteDepthMaps(dir.path(), maps);
  EXPECT_EQ(std::set<std::string>(files.begin(), files.end()).size(), files.size());
  EXPECT_TRUE(fs::exists(dir / "c.png")) << "others keep their name";
  const std::vector<DepthMap> read = ReadDepthMaps(dir.path(), names, std::vector<Camera>(names.size(), kCamera));
  for (size_t v = 0; v < names.size(); ++v) {
    EXPECT_EQ(read[v].name, names[v]);
    EXPECT_FLOAT_EQ(read[v].inv_depth[0], static_cast<float>(v + 1));
  }
}

TEST_F(DepthFilesTest, RoundTripUnknownDepth) {
  const TempDir dir;
  DepthMap map = MapNamed("a.jpg");
  map.inv_depth.assign(map.size(), 0);
  map.confidence.assign(map.size(), 0);
  map.normals.assign(map.size(), Eigen::Vector3f::Zero());
  WriteDepthMaps(dir.path(), {map});
  const DepthMap read = ReadDepthMaps(dir.path(), {"a.jpg"}, {kCamera}).at(0);
  EXPECT_EQ(read.inv_depth, map.inv_depth);
  EXPECT_EQ(read.confidence, map.confidence);
}

TEST_F(DepthFilesTest, ReportDamagedParams) {
  const auto error_with = [this](const std::string& json) {
    Put("depth_params.json", json);
    return Error();
  };
  EXPECT_THAT(error_with("{\"a\":"), AllOf(HasSubstr("depth_params.json: is not valid JSON"), HasSubstr("made again")));
  for (const char* json : {"[]", "3", "{}", "{\"b\": {\"scale\": 1, \"offset\": 0}}", "{\"a\": 7}",
                           "{\"a\": {\"scale\": \"1\", \"offset\": 0}}", "{\"a\": {\"scale\": 1e99, \"offset\": 0}}"}) {
    EXPECT_THAT(error_with(json), AllOf(HasSubstr("depth_params.json: "), HasSubstr("scale for a"))) << json;
  }
  EXPECT_THAT(error_with("{\"a\": {\"scale\": 1}}"), HasSubstr("offset for a"));
  fs::remove(dir_ / "depth_params.json");
  EXPECT_THAT(Error(), HasSubstr("depth_params.json"));
}

TEST_F(DepthFilesTest, ReportWrongImageSize) {
  const TempDir other;
  DepthMap map = TrueDepth(kSlanted.Take(Resized(kCamera, 18, 24), "a.jpg"), kSlanted, 1);
  WriteDepthMaps(other.path(), {map});
  for (const char* file : {"a.png", "confidence/a.png", "normals/a.png"}) {
    const std::string before = ReadFile(dir_ / file);
    Put(file, ReadFile(other / file));
    EXPECT_THAT(Error(), AllOf(HasSubstr((dir_ / file).string() + ": is 18 x 24, its view 24 x 18"))) << file;
    Put(file, before);
  }
  EXPECT_EQ(Error(), "");
}

TEST_F(DepthFilesTest, RefuseEightBitDepth) {
  Put("a.png", ReadFile(dir_ / "confidence/a.png"));
  EXPECT_THAT(Error(), AllOf(HasSubstr((dir_ / "a.png").string()), HasSubstr("16 bits")));
}

TEST_F(DepthFilesTest, ReportTruncatedAndMissingImages) {
  for (const char* file : {"a.png", "confidence/a.png", "normals/a.png"}) {
    const std::string before = ReadFile(dir_ / file);
    Cut(file);
    EXPECT_THAT(Error(), HasSubstr((dir_ / file).string() + ": ")) << file;
    fs::remove(dir_ / file);
    EXPECT_THAT(Error(), HasSubstr((dir_ / file).string())) << file;
    Put(file, before);
  }
}

TEST(WriteDepthMaps, ReportsUnwritableFolder) {
  const TempDir dir;
  WriteFileAtomically(dir / "file", "x");
  EXPECT_THROW(WriteDepthMaps(dir / "file", {MapNamed("a.jpg")}), RunError);
  EXPECT_THROW(WriteDensePly(dir / "file" / "dense.ply", {}), RunError);
}

TEST(WriteDensePly, WritesHeaderAndPoints) {
  const TempDir dir;
  DensePoint point;
  point.xyz = {1, -2, 3.5f};
  point.normal = {0, 0, -1};
  point.rgb = {0, 0.5f, 7};
  point.confidence = 0.75f;
  point.views = 300;
  WriteDensePly(dir / "dense.ply", {point, point});
  const std::string bytes = ReadFile(dir / "dense.ply");
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty float confidence\nproperty uchar views\nend_header\n";
  constexpr size_t kPoint = 6 * 4 + 3 + 4 + 1;
  ASSERT_EQ(bytes.substr(0, header.size()), header);
  ASSERT_EQ(bytes.size(), header.size() + 2 * kPoint);
  const char* second = bytes.data() + header.size() + kPoint;
  float values[6], confidence;
  std::memcpy(values, second, sizeof(values));
  std::memcpy(&confidence, second + 27, sizeof(confidence));
  EXPECT_THAT(values, testing::ElementsAre(1, -2, 3.5f, 0, 0, -1));
  EXPECT_THAT(std::vector<uint8_t>(second + 24, second + 27), testing::ElementsAre(0, 128, 255));
  EXPECT_EQ(confidence, 0.75f);
  EXPECT_EQ(static_cast<uint8_t>(second[31]), 255) << "as many as a byte can say";
}

TEST_F(DepthFilesTest, KeepViewsWithoutDepth) {
  const DepthMap none{"b.jpg", kCamera, {}, {}, {}};
  const std::vector<std::string> files = WriteDepthMaps(dir_.path(), {none, MapNamed("a.jpg")});
  EXPECT_THAT(files, testing::Not(testing::Contains("b.png")));
  const std::vector<DepthMap> read = ReadDepthMaps(dir_.path(), {"b.jpg", "a.jpg"}, {kCamera, kCamera});
  EXPECT_EQ(read.at(0).size(), 0u);
  EXPECT_EQ(read.at(0).name, "b.jpg");
  EXPECT_EQ(read.at(1).inv_depth, Read().at(0).inv_depth);
}

}  // namespace
}  // namespace oraclegs
