#include "oraclegs/datasets/bundler.h"

#include "datasets/posed_folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class BundlerTest : public PosedFolder {
 protected:
  BundlerTest() {
    for (SceneView& view : truth_) view.intrinsics.params = {30, 30, 12, 8};
  }
  void Write(const std::string& bundle, const std::string& list, const char* name = "bundle.out") {
    WriteText(root() / name, bundle);
    WriteText(root() / "list.txt", list);
  }
};

TEST_F(BundlerTest, ReadsTrueCamerasAndPoints) {
  const std::vector<ScenePoint> points = {{{1, 2, 3}, {10, 20, 30}, {2, 0}}, {{4, 5, 6}, {1, 2, 3}, {1, 1}}};
  for (const char* name : {"bundle/bundle.out", "bundle.out", "scene.rd.out"}) {
    Write(BundleFile(truth_, points), BundleList(truth_), name);
    const Scene scene = Read();
    EXPECT_EQ(scene.format, SceneFormat::kBundler) << name;
    ExpectTruth(scene);
    ASSERT_THAT(scene.points, SizeIs(2));
    EXPECT_EQ(scene.points[0].xyz, Eigen::Vector3d(1, 2, 3));
    EXPECT_THAT(scene.points[0].rgb, ElementsAre(10, 20, 30));
    EXPECT_THAT(scene.points[0].views, ElementsAre(0, 2));
    EXPECT_THAT(scene.points[1].views, ElementsAre(1));
    fs::remove(root() / name);
  }
}

TEST_F(BundlerTest, ReadsRadialCoefficients) {
  Write(BundleFile(truth_, {}, -0.1, 0.02), BundleList(truth_));
  const Intrinsics lens = Read().views[0].intrinsics;
  EXPECT_EQ(lens.model, CameraModel::kRadial);
  EXPECT_THAT(lens.params, ElementsAre(30, 12, 8, -0.1, 0.02));
}

TEST_F(BundlerTest, LeavesOutPhotosThatWereNotPlacedOrAreGone) {
  truth_[1].intrinsics.params[0] = 0;
  fs::remove(root() / "images/002.png");
  const std::vector<ScenePoint> points = {{{1, 2, 3}, {}, {1, 2}}, {{4, 5, 6}, {}, {0, 1}}};
  Write(BundleFile(truth_, points), BundleList(truth_));
  const Scene scene = Read();
  ASSERT_THAT(scene.views, SizeIs(1));
  EXPECT_THAT(scene.missing_images, ElementsAre("002.png"));
  EXPECT_THAT(events_.warnings, Contains(HasSubstr("has no pose for 1 photo and leaves it out: 001.png")));
  ASSERT_THAT(scene.points, SizeIs(1));
  EXPECT_THAT(scene.points[0].views, ElementsAre(0));
}

TEST_F(BundlerTest, SaysWhatIsWrongAndWhere) {
  const std::string whole = BundleFile(truth_), list = BundleList(truth_);
  Write("# Bundle file v0.4\n1 2", list);
  EXPECT_THAT(ReadError(), HasSubstr("bundle.out: begins with '# Bundle file v0.4', and '# Bundle file v0.3' is read"));
  Write(whole.substr(0, whole.size() / 2), list);
  EXPECT_THAT(ReadError(), HasSubstr("is the file cut short?"));
  Write("# Bundle file v0.3\n4000000000 0\n", list);
  EXPECT_THAT(ReadError(), HasSubstr("says it has 4000000000 cameras, which do not fit into its 32 bytes"));
  Write("# Bundle file v0.3\n0 1\n1 2 3\n1 x 3\n", list);
  EXPECT_THAT(ReadError(), HasSubstr("line 4: expected a number, found 'x'"));
  Write(BundleFile(truth_, {{{1, 2, 3}, {}, {7}}}), list);
  EXPECT_THAT(ReadError(), HasSubstr("point 0 is seen by camera 7, and there are 3"));
  Write(whole, "a.jpg\n");
  EXPECT_THAT(ReadError(), HasSubstr("bundle.out: has 3 cameras, and"));
  Write(whole, "\x01\n\x02\n\x03\n");
  EXPECT_THAT(ReadError(), HasSubstr("list.txt: its photo 1 has no name, or one with control characters"));
  truth_[2].cam_from_world->linear() *= 2;
  Write(BundleFile(truth_), list);
  EXPECT_THAT(ReadError(), HasSubstr("camera 2 (002.png): its matrix is a rotation scaled by"));
}

}  // namespace
}  // namespace oraclegs
