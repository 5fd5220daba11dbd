#include "oraclegs/datasets/record3d.h"

#include <nlohmann/json.hpp>

#include "datasets/posed_folder.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class Record3dTest : public PosedFolder {
 protected:
  /// The images as rgbd/0.jpg and on.
  void WriteImages(const std::string& folder) {
    for (size_t i = 0; i < truth_.size(); ++i) {
      const Image8 image = ReadImage(root() / "images" / truth_[i].name);
      truth_[i].name = fmt::format("{}.jpg", i);
      WriteText(root() / folder / truth_[i].name, CompressJpeg(image, 90));
    }
    fs::remove_all(root() / "images");
  }
  json Metadata() const {
    const Intrinsics& lens = truth_[0].intrinsics;
    json poses = json::array();
    for (const SceneView& view : truth_) {
      const Eigen::Isometry3d world_from_cam = view.cam_from_world->inverse();
      const Eigen::Quaterniond q(world_from_cam.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal());
      const Eigen::Vector3d p = world_from_cam.translation();
      poses.push_back({q.x(), q.y(), q.z(), q.w(), p.x(), p.y(), p.z()});
    }
    return {{"K", {lens.fx(), 0, 0, 0, lens.fy(), 0, lens.cx(), lens.cy(), 1}},
            {"w", lens.width},
            {"h", lens.height},
            {"fps", 60},
            {"poses", poses}};
  }
  std::string ErrorOf(const json& metadata) {
    WriteText(root() / "metadata.json", metadata.dump());
    return ReadError();
  }
};

TEST_F(Record3dTest, ReadsTrueCameras) {
  WriteImages("rgbd");
  WriteText(root() / "metadata", Metadata().dump());
  const Scene scene = Read();
  EXPECT_EQ(scene.format, SceneFormat::kRecord3d);
  ExpectTruth(scene);
  EXPECT_THAT(events_.notes, Contains(AllOf(HasSubstr("depth of Record3D"), HasSubstr("is not read"))));
  fs::rename(root() / "metadata", root() / "metadata.json");
  fs::rename(root() / "rgbd", root() / "rgb");
  ExpectTruth(Read());
}

TEST_F(Record3dTest, LeavesOutImagesWithoutAPose) {
  WriteImages("rgbd");
  json metadata = Metadata();
  metadata["poses"].erase(2);
  WriteText(root() / "metadata", metadata.dump());
  fs::rename(root() / "rgbd/0.jpg", root() / "rgbd/cover.jpg");
  EXPECT_THAT(Read().views, SizeIs(1));
  EXPECT_THAT(events_.warnings, Contains(HasSubstr("has no pose for 2 photos and leaves them out")));
}

TEST_F(Record3dTest, SaysWhatIsWrong) {
  WriteImages("rgbd");
  json metadata = Metadata();
  metadata["poses"][1] = {0, 0, 0, 0, 1, 2, 3};
  EXPECT_THAT(ErrorOf(metadata), HasSubstr("metadata.json: pose 1: has no rotation"));
  metadata["poses"][1] = {0, 0, 0, 1};
  EXPECT_THAT(ErrorOf(metadata), HasSubstr("pose 1: is no list of 7 numbers"));
  metadata["poses"][1] = {0, 0, 0, 1, "x", 2, 3};
  EXPECT_THAT(ErrorOf(metadata), HasSubstr("pose 1: \"transform_matrix\" is not a finite number"));
  metadata = Metadata();
  metadata["K"].erase(0);
  EXPECT_THAT(ErrorOf(metadata), HasSubstr("\"K\": is no list of 9 numbers"));
  metadata = Metadata();
  metadata["poses"] = 3;
  EXPECT_THAT(ErrorOf(metadata), HasSubstr("metadata.json: has no \"poses\""));
  WriteText(root() / "metadata.json", "{\"K\"");
  EXPECT_THAT(ReadError(), HasSubstr("metadata.json: is not valid JSON"));
}

}  // namespace
}  // namespace oraclegs
