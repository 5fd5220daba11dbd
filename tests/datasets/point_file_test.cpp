#include "oraclegs/datasets/point_file.h"

#include <nlohmann/json.hpp>

#include "datasets/posed_folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class PointFileTest : public ::testing::Test {
 protected:
  PointFileTest() {
    WriteImage(dir_ / "scene/a.png");
    WriteText(dir_ / "scene/p.ply",
              "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty "
              "uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 -5 10 20 30\n0 0 5 1 2 3\n");
    Name("p.ply");
  }
  void Name(const std::string& points) {
    const json identity = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    const json frame = {{"file_path", "a.png"}, {"transform_matrix", identity}};
    WriteText(dir_ / "scene/transforms.json", json{{"fl_x", 5}, {"ply_file_path", points}, {"frames", {frame}}}.dump());
  }
  Scene Read(bool allow_outside = false) {
    return ReadScene(dir_ / "scene", {{}, allow_outside}, events_.AsListener());
  }

  TempDir dir_;
  EventRecorder events_;
};

TEST_F(PointFileTest, KeepsPointsThatAPhotoShows) {
  const Scene scene = Read();
  ASSERT_THAT(scene.points, SizeIs(1));
  EXPECT_EQ(scene.points[0].xyz, Eigen::Vector3d(0, 0, -5));
  EXPECT_THAT(scene.points[0].rgb, ElementsAre(10, 20, 30));
  EXPECT_THAT(scene.points[0].views, ElementsAre(0));
  EXPECT_THAT(events_.notes, Contains(HasSubstr("p.ply: 2 of 2 points have no track")));
  EXPECT_THAT(events_.warnings, Contains(HasSubstr("p.ply: 1 of 2 points are left out")));
}

TEST_F(PointFileTest, StaysInTheFolder) {
  fs::rename(dir_ / "scene/p.ply", dir_ / "p.ply");
  Name("../p.ply");
  EXPECT_THAT(MessageOf<InputError>([&] { Read(); }), HasSubstr("which lies outside the scene's folder"));
  EXPECT_THAT(Read(true).points, SizeIs(1));
}

TEST_F(PointFileTest, NamesADamagedFile) {
  WriteText(dir_ / "scene/p.ply", "ply\n");
  EXPECT_THAT(MessageOf<InputError>([&] { Read(); }), HasSubstr("p.ply"));
}

TEST_F(PointFileTest, ReadsThePlyOfAModelWithoutOtherPoints) {
  WriteTinyModel(dir_ / "scene/sparse/0");
  for (const char* name : {"a.png", "b.png", "c.png"}) WriteImage(dir_ / "scene/images" / name);
  fs::remove(dir_ / "scene/sparse/0/points3D.bin");
  fs::copy_file(dir_ / "scene/p.ply", dir_ / "scene/sparse/0/points3D.ply");
  Read();
  EXPECT_THAT(events_.notes, Contains(HasSubstr("points3D.ply: 2 of 2 points have no track")));
}

}  // namespace
}  // namespace oraclegs
