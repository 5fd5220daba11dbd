#include "oraclegs/datasets/neus.h"

#include <cmath>

#include "datasets/posed_folder.h"
#include "oraclegs/scene/masks.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class NeusTest : public PosedFolder {
 protected:
  void Write(const std::string& bytes, const char* name = "cameras_sphere.npz") { WriteText(root() / name, bytes); }
  /// The poses in the unit sphere that NeusFile's scale matrix makes.
  void MoveTruthIntoSphere() {
    for (SceneView& view : truth_) {
      const Eigen::Vector3d center = (view.cam_from_world->inverse().translation() - Eigen::Vector3d(10, -4, 2)) / 3;
      view.cam_from_world->translation() = -(view.cam_from_world->linear() * center);
    }
  }
};

TEST_F(NeusTest, ReadsTrueCameras) {
  for (const double factor : {1.0, -0.37}) {
    const std::vector<SceneView> written = truth_;
    // In NeusFile, world_mat is that of the truth: world_mat * scale_mat sees the truth itself.
    Write(NeusFile(written, factor));
    const Scene scene = Read();
    EXPECT_EQ(scene.format, SceneFormat::kNeus);
    ExpectTruth(scene);
  }
  EXPECT_THAT(events_.warnings, IsEmpty());
  EXPECT_THAT(events_.notes, Contains(HasSubstr("is read as NeuS (cameras.npz): 3 views")));
}

TEST_F(NeusTest, ReadsWithoutScaleAndFromIdrsFile) {
  std::vector<std::pair<std::string, std::string>> members;
  for (const auto& [name, bytes] : ReadZip(NeusFile(truth_), 100, "x")) {
    if (name.starts_with("world")) members.emplace_back(name, bytes);
  }
  Write(WriteZip(members), "cameras.npz");
  MoveTruthIntoSphere();
  const Scene scene = Read();
  ASSERT_EQ(scene.views.size(), 3u);
  EXPECT_NEAR(scene.views[2].intrinsics.fx(), truth_[2].intrinsics.fx(), 1e-6);
}

TEST_F(NeusTest, TakesImagesAndMasksInTheOrderOfTheirNames) {
  Write(NeusFile(truth_));
  fs::rename(root() / "images", root() / "image");
  for (const char* name : {"a.png", "b.png", "c.png"}) WriteImage(root() / "mask" / name, 24, 16);
  const Scene scene = Read();
  ExpectTruth(scene);
  EXPECT_EQ(scene.views[1].mask_path, root() / "mask/b.png");
}

TEST_F(NeusTest, SaysWhichMatrixIsWrong) {
  std::vector<SceneView> fewer(truth_.begin(), truth_.end() - 1);
  Write(NeusFile(fewer));
  EXPECT_THAT(ReadError(), HasSubstr("cameras_sphere.npz: has 2 cameras, and"));
  Write(WriteZip({{"a.npy", "x"}}));
  fs::remove(root() / "images/001.png");
  fs::remove(root() / "images/002.png");
  EXPECT_THAT(ReadError(), HasSubstr("cameras_sphere.npz: has no world_mat_0"));
  Write(WriteZip({{"world_mat_0.npy", NpyOf("(2, 2)", {1, 2, 3, 4})}}));
  EXPECT_THAT(ReadError(), HasSubstr("world_mat_0: is 2 x 2, expected 4 x 4"));
  Write(WriteZip({{"world_mat_0.npy", NpyOf("(3, 4)", std::vector<double>(12))}}));
  EXPECT_THAT(ReadError(), HasSubstr("world_mat_0 (000.png): is the projection of no camera"));
  Write(WriteZip({{"world_mat_0.npy", NpyOf("(3, 4)", std::vector<double>(12, std::nan("")))}}));
  EXPECT_THAT(ReadError(), HasSubstr("is the projection of no camera"));
  Write("PK");
  EXPECT_THAT(ReadError(), HasSubstr("cameras_sphere.npz: is not a zip archive"));
}

TEST_F(NeusTest, WarnsOfSkewedAxes) {
  Eigen::Matrix<double, 3, 4> p;
  p << 30, 6, 12, 0, 0, 30, 8, 0, 0, 0, 1, 5;
  std::vector<double> rows;
  for (int i = 0; i < 12; ++i) rows.push_back(p(i / 4, i % 4));
  for (const char* name : {"001.png", "002.png"}) fs::remove(root() / "images" / name);
  Write(WriteZip({{"world_mat_0.npy", NpyOf("(3, 4)", rows)}}));
  EXPECT_NEAR(Read().views[0].intrinsics.fx(), 30, 1e-9);
  EXPECT_THAT(events_.warnings, Contains(HasSubstr("not at right angles; leaving that out moves pixels by up to 1.6")));
}

TEST(TakeApart, FindsTheSkew) {
  Eigen::Matrix<double, 3, 4> p;
  p << -60, -3, -24, -120, 0, -60, -16, -80, 0, 0, -2, -10;
  const ProjectionParts parts = TakeApart(p, "x");
  EXPECT_NEAR(parts.skew, 1.5, 1e-12);
  EXPECT_NEAR(parts.camera.cy, 8, 1e-12);
  EXPECT_NEAR((parts.camera.cam_from_world.translation() - Eigen::Vector3d(0, 0, 5)).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace oraclegs
