#include "oraclegs/depth/given_depth.h"

#include <gmock/gmock.h>

#include "depth/surfaces.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Camera kGivenCamera = CameraAt({0, 0.2, -4}, {0, 0, 0}, 24, 18);

class GivenDepthTest : public testing::Test {
 protected:
  /// Writes the true depth of a slanted plane, of `factor` times the camera's size, but for one unknown pixel.
  void Write(int factor) {
    Camera large = kGivenCamera;
    large.width *= factor, large.height *= factor, large.fx *= factor, large.fy *= factor;
    large.cx *= factor, large.cy *= factor;
    const DepthMap map = TrueDepth(kSlanted.Take(large, "a.jpg"), kSlanted, 1);
    std::vector<uint16_t> values;
    for (const float inv_depth : map.inv_depth) values.push_back(static_cast<uint16_t>(inv_depth * 65536 / 2));
    values[0] = 0;
    WritePng16(dir_ / "a.png", large.width, large.height, values);
    WriteFileAtomically(dir_ / "depth_params.json", R"({"a": {"scale": 2, "offset": 0, "med_scale": 1}})");
  }
  DepthMap Read(double unit = 1) const { return ReadGivenDepth(dir_.path(), {"a.jpg"}, {kGivenCamera}, unit).front(); }
  std::string Error() const {
    return MessageOf<InputError>([&] { Read(); });
  }

  TempDir dir_;
};

TEST_F(GivenDepthTest, HasDepthsAndNormalsOfTheSurface) {
  Write(1);
  const DepthMap truth = TrueDepth(kSlanted.Take(kGivenCamera, "a.jpg"), kSlanted, 1), read = Read();
  EXPECT_EQ(read.confidence[0], 0);
  EXPECT_EQ(read.inv_depth[0], 0);
  int close = 0;
  for (size_t i = 1; i < truth.size(); ++i) {
    EXPECT_NEAR(read.inv_depth[i], truth.inv_depth[i], 2. / 65536);
    EXPECT_GE(read.confidence[i], kConfident);
    close += read.normals[i].dot(truth.normals[i]) > 0.99f;
  }
  EXPECT_GT(close, static_cast<int>(truth.size() * 9 / 10));
  EXPECT_NEAR(Read(2).inv_depth[5], 2 * truth.inv_depth[5], 4. / 65536) << "units of the cameras twice as long";
}

TEST_F(GivenDepthTest, MayBeOfAnotherSize) {
  Write(3);
  const DepthMap truth = TrueDepth(kSlanted.Take(kGivenCamera, "a.jpg"), kSlanted, 1), read = Read();
  for (size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(read.inv_depth[i], truth.inv_depth[i], 2. / 65536);
}

TEST_F(GivenDepthTest, TakesConfidenceWhereItIs) {
  Write(1);
  std::filesystem::create_directory(dir_ / "confidence");
  Image8 confidence{2, 1, 1, {0, 255}};
  WritePng(dir_ / "confidence" / "a.png", confidence);
  const DepthMap read = Read();
  EXPECT_EQ(read.confidence[1], 0);
  EXPECT_EQ(read.confidence[23], 1);
  EXPECT_EQ(GivenDepthFiles(dir_.path(), {"a.jpg"}).size(), 3u);
}

TEST_F(GivenDepthTest, NamesWhatIsWrong) {
  EXPECT_THAT(Error(), AllOf(HasSubstr("depth_params.json: is missing"), HasSubstr("every training view")));
  Write(1);
  WriteFileAtomically(dir_ / "depth_params.json", R"({"a": {"scale": 2}})");
  EXPECT_THAT(Error(), HasSubstr("has no number \"offset\" for \"a\""));
  WriteFileAtomically(dir_ / "depth_params.json", "{");
  EXPECT_THAT(Error(), HasSubstr("is not valid JSON"));
  Write(1);
  WriteFileAtomically(dir_ / "a.png", "no image");
  EXPECT_THAT(Error(), HasSubstr("a.png"));
  EXPECT_THAT(MessageOf<InputError>([&] { GivenDepthFiles(dir_ / "none", {}); }), HasSubstr("is no folder"));
}

}  // namespace
}  // namespace oraclegs
