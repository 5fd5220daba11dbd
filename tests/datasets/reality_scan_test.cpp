#include "oraclegs/datasets/reality_scan.h"

#include "datasets/posed_folder.h"

namespace oraclegs {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class RealityScanTest : public PosedFolder {
 protected:
  void Write(const std::string& text) { WriteText(root() / "export.csv", text); }
};

TEST(RotationOfAngles, LooksDownThenTurns) {
  const Eigen::Vector3d forward(0, 0, 1), right(1, 0, 0);
  const auto in_world = [](double h, double p, double r, const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return RotationOfAngles(h, p, r).transpose() * v;
  };
  EXPECT_NEAR((in_world(0, 0, 0, forward) - Eigen::Vector3d(0, 0, -1)).norm(), 0, 1e-12);
  EXPECT_NEAR((in_world(0, 0, 0, right) - Eigen::Vector3d(1, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((in_world(0, 90, 0, forward) - Eigen::Vector3d(0, 1, 0)).norm(), 0, 1e-12);   // to the north
  EXPECT_NEAR((in_world(90, 90, 0, forward) - Eigen::Vector3d(1, 0, 0)).norm(), 0, 1e-12);  // to the east
}

TEST_F(RealityScanTest, ReadsTrueCameras) {
  for (const char* mark : {"", "\xef\xbb\xbf"}) {
    Write(mark + RealityScanCsv(truth_));
    const Scene scene = Read();
    EXPECT_EQ(scene.format, SceneFormat::kRealityScan);
    ExpectTruth(scene);
  }
  EXPECT_THAT(events_.notes, Contains(HasSubstr("is read as RealityScan's cameras (CSV): 3 views")));
}

TEST_F(RealityScanTest, ReadsCoefficients) {
  Write(RealityScanCsv(truth_, "0.1,0.2,0.3,0,0.01,0.02"));
  const Intrinsics lens = Read().views[0].intrinsics;
  EXPECT_THAT(std::vector<double>(lens.params.begin() + 4, lens.params.end()),
              ElementsAre(0.1, 0.2, 0.01, 0.02, 0.3, 0, 0, 0));
}

TEST_F(RealityScanTest, LeavesOutPhotosThatAreGone) {
  std::filesystem::remove(root() / "images/001.png");
  Write(RealityScanCsv(truth_));
  EXPECT_THAT(Read().views, SizeIs(2));
}

TEST_F(RealityScanTest, SaysWhatIsWrongAndWhere) {
  const std::string head = "#name,x,y,alt,heading,pitch,roll,f,px,py\n";
  Write(head);
  EXPECT_THAT(ReadError(), HasSubstr("export.csv: names no photo"));
  Write(head + "\n000.png,1,2\n");
  EXPECT_THAT(ReadError(), HasSubstr("line 3: has 3 cells, and the first line names 10"));
  Write("#name,x,y,alt,heading,pitch,roll,f,f,f,px\n000.png,1,2,3,4,5,6,50,0,0\n");
  EXPECT_THAT(ReadError(), HasSubstr("line 2: has 10 cells, and the first line names 11"));
  Write(head + "000.png,1,2,3,4,5,6,7;5,0,0\n");
  EXPECT_THAT(ReadError(), HasSubstr("line 2 (000.png): f is '7;5', expected a number with a point"));
  Write(head + "000.png,1,2,3,4,5,6,50,0.7,0\n");
  EXPECT_THAT(ReadError(), HasSubstr("px is 0.7, expected a share of the longer side"));
  Write(head + ",1,2,3,4,5,6,50,0,0\n");
  EXPECT_THAT(ReadError(), HasSubstr("its photo 1 has no name"));
}

}  // namespace
}  // namespace oraclegs
