#include "oraclegs/datasets/llff.h"

#include <cmath>
#include <cstdlib>

#include "datasets/posed_folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;

class LlffTest : public PosedFolder {
 protected:
  void Write(const std::string& bytes) { WriteText(root() / "poses_bounds.npy", bytes); }
};

TEST_F(LlffTest, ReadsTrueCameras) {
  Write(LlffFile(truth_));
  const Scene scene = Read();
  EXPECT_EQ(scene.format, SceneFormat::kLlff);
  ExpectTruth(scene);
  EXPECT_THAT(events_.notes, Contains(HasSubstr("is read as LLFF (poses_bounds.npy): 3 views")));
}

TEST_F(LlffTest, ScalesCamerasToTheSmallerCopiesThatAreThere) {
  Write(LlffFile(truth_, 8));
  fs::rename(root() / "images", root() / "images_8");
  ExpectTruth(Read());
  EXPECT_THAT(events_.notes, Contains(HasSubstr("the cameras are scaled to them")));
}

TEST_F(LlffTest, PrefersTheLargestImages) {
  Write(LlffFile(truth_));
  for (const char* folder : {"images_4", "images_8", "images_x"}) {
    fs::create_directories(root() / folder);
    for (const SceneView& view : truth_) WriteImage(root() / folder / view.name, 6, 4);
  }
  ExpectTruth(Read());
  fs::remove_all(root() / "images");
  EXPECT_EQ(Read().views[0].image_path, root() / "images_4" / truth_[0].name);
  EXPECT_EQ(Read({.images = "images_8"}).views[0].image_path, root() / "images_8" / truth_[0].name);
}

TEST_F(LlffTest, RefusesAnotherNumberOfImages) {
  std::vector<SceneView> more = truth_;
  more.push_back(truth_[0]);
  Write(LlffFile(more));
  EXPECT_THAT(ReadError(), HasSubstr("poses_bounds.npy: has 4 rows, and"));
  EXPECT_THAT(ReadError(), HasSubstr("images has 3 images"));
  more.resize(2);
  Write(LlffFile(more));
  EXPECT_THAT(ReadError(), HasSubstr("has 2 rows"));
}

TEST_F(LlffTest, RefusesWhatIsNoRowOfLlff) {
  Write(NpyOf("(3, 5)", std::vector<double>(15)));
  EXPECT_THAT(ReadError(), HasSubstr("is 3 x 5, expected 17 numbers for each image"));
  Write(NpyOf("(3, 17)", std::vector<double>(51)));
  EXPECT_THAT(ReadError(), HasSubstr("row 0 (000.png): has an image side of 0 pixels"));
  std::vector<double> row(17, std::nan(""));
  row.resize(51);
  Write(NpyOf("(3, 17)", row));
  EXPECT_THAT(ReadError(), HasSubstr("row 0 (000.png): has numbers that are not finite"));
  truth_[1].cam_from_world->linear() *= 3;
  Write(LlffFile(truth_));
  EXPECT_THAT(ReadError(), HasSubstr("row 1 (001.png) is a rotation scaled by"));
}

TEST(Llff, ReadsFernAsItsTransformsSay) {
  const char* named = std::getenv("ORACLEGS_DATA");
  const fs::path fern = fs::path(named == nullptr ? "" : named) / "fern";
  if (!fs::exists(fern / "poses_bounds.npy")) GTEST_SKIP() << "needs fern/poses_bounds.npy in $ORACLEGS_DATA";
  TempDir temp;
  fs::create_directory_symlink(fern / "images_8", temp / "images_8");
  fs::copy_file(fern / "poses_bounds.npy", temp / "poses_bounds.npy");
  const Scene llff = ReadScene(temp.path(), {}, Silent()), transforms = ReadScene(fern, {}, Silent());
  ASSERT_EQ(llff.views.size(), 20u);
  ASSERT_EQ(transforms.views.size(), 20u);
  for (size_t i = 0; i < 20; ++i) {
    const SceneView &a = llff.views[i], &b = transforms.views[i];
    EXPECT_EQ(a.name, fs::path(b.name).filename());
    EXPECT_LT((a.cam_from_world->matrix() - b.cam_from_world->matrix()).cwiseAbs().maxCoeff(), 1e-6) << a.name;
    EXPECT_EQ(a.intrinsics.width, b.intrinsics.width);
    EXPECT_NEAR(a.intrinsics.fx(), b.intrinsics.fx(), 1e-3);
    EXPECT_NEAR(a.intrinsics.cx(), b.intrinsics.cx(), 1e-3);
  }
}

}  // namespace
}  // namespace oraclegs
