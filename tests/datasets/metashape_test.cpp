#include "oraclegs/datasets/metashape.h"

#include "datasets/posed_folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class MetashapeTest : public PosedFolder {
 protected:
  void Write(const std::string& text, const char* name = "cameras.xml") { WriteText(root() / name, text); }
  /// The file with one text in place of another.
  void WriteWith(const std::string& old, const std::string& text) {
    std::string xml = MetashapeXml(truth_);
    const size_t at = xml.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    Write(xml.replace(at, old.size(), text));
  }
};

TEST_F(MetashapeTest, ReadsTrueCameras) {
  for (const char* name : {"cameras.xml", "project.xml"}) {
    Write(MetashapeXml(truth_), name);
    const Scene scene = Read();
    EXPECT_EQ(scene.format, SceneFormat::kMetashape);
    ExpectTruth(scene);
    fs::remove(root() / name);
  }
  EXPECT_THAT(events_.notes, Contains(HasSubstr("is read as Metashape's cameras (XML): 3 views")));
}

TEST_F(MetashapeTest, ReadsAChunkWithoutAPlace) {
  std::string xml = MetashapeXml(truth_, "", {0, 1, {0, 0, 0}});
  const size_t begin = xml.find("  <components"), end = xml.find("  <cameras");
  Write(xml.erase(begin, end - begin));
  ExpectTruth(Read());
}

TEST_F(MetashapeTest, ReadsItsCoefficientsInOpenCvsOrder) {
  Write(MetashapeXml(truth_, "<b1>2</b1><k1>0.1</k1><k2>0.2</k2><k3>0.3</k3><p1>0.01</p1><p2>0.02</p2>"));
  const Intrinsics lens = Read().views[0].intrinsics;
  EXPECT_EQ(lens.model, CameraModel::kFullOpenCv);
  EXPECT_NEAR(lens.fx() - lens.fy(), 2, 1e-9);
  EXPECT_THAT(std::vector<double>(lens.params.begin() + 4, lens.params.end()),
              ElementsAre(0.1, 0.2, 0.02, 0.01, 0.3, 0, 0, 0));
  WriteWith("type=\"frame\">\n    <res", "type=\"fisheye\">\n    <res");
  EXPECT_EQ(Read().views[0].intrinsics.model, CameraModel::kOpenCvFisheye);
}

TEST_F(MetashapeTest, LeavesOutCamerasWithoutAPoseOrDisabled) {
  WriteWith("label=\"000\"", "label=\"000\" enabled=\"false\"");
  EXPECT_THAT(Read().views, SizeIs(2));
  WriteWith("<transform>", "<nothing>");  // of the component, which then has no place
  EXPECT_THAT(ReadError(), HasSubstr("cameras.xml: is not valid XML"));
  std::string xml = MetashapeXml(truth_);
  const size_t begin = xml.rfind("<transform>"), end = xml.rfind("</transform>");
  Write(xml.erase(begin, end - begin + 12));
  EXPECT_THAT(Read().views, SizeIs(2));
  EXPECT_THAT(events_.warnings, Contains(HasSubstr("has no pose for 1 photo and leaves it out: 002")));
}

TEST_F(MetashapeTest, ReadsCamerasInGroups) {
  std::string xml = MetashapeXml(truth_);
  xml.insert(xml.find("   <camera id"), "<group id=\"0\" label=\"Group 1\">");
  xml.insert(xml.find("  </cameras>"), "</group>");
  Write(xml);
  ExpectTruth(Read());
}

TEST_F(MetashapeTest, SaysWhatIsWrongAndWhere) {
  WriteWith("type=\"frame\">\n    <res", "type=\"spherical\">\n    <res");
  EXPECT_THAT(ReadError(), HasSubstr("sensor 0: is of type 'spherical'; frame and fisheye cameras are read"));
  WriteWith("<f>", "<g>");
  EXPECT_THAT(ReadError(), HasSubstr("is not valid XML: "));
  Write(MetashapeXml(truth_, "<k4>0.1</k4>"));
  EXPECT_THAT(ReadError(), HasSubstr("sensor 0: \"k4\" of a camera that is no fisheye"));
  Write(MetashapeXml(truth_, "<k1>small</k1>"));
  EXPECT_THAT(ReadError(), HasSubstr("sensor 0: <k1> is 'small', expected a number"));
  WriteWith("sensor_id=\"0\"", "sensor_id=\"5\"");
  EXPECT_THAT(ReadError(), HasSubstr("camera '000': its sensor 5 is missing"));
  WriteWith("<scale>2.5", "<scale>-1");
  EXPECT_THAT(ReadError(), HasSubstr("component 0: <scale> is -1, must be more than 0"));
  WriteWith("<rotation>1", "<rotation>7");
  EXPECT_THAT(ReadError(), HasSubstr("component 0: <rotation> is not a rotation"));
  std::string xml = MetashapeXml(truth_);
  Write(xml.insert(xml.rfind("</transform>"), " 1"));
  EXPECT_THAT(ReadError(), HasSubstr("camera '002': <transform> is '"));
  WriteWith("<calibration type=\"frame\" class=\"adjusted\">", "<calibration><g>1</g>");
  std::string no_focal = MetashapeXml(truth_);
  no_focal.erase(no_focal.find("<f>"), no_focal.find("</f>") + 4 - no_focal.find("<f>"));
  Write(no_focal);
  EXPECT_THAT(ReadError(), HasSubstr("sensor 0: has no calibration with <f>"));
  std::string no_size = MetashapeXml(truth_);
  for (size_t at; (at = no_size.find("width=\"24\"")) != std::string::npos;) no_size.erase(at, 10);
  Write(no_size);
  EXPECT_THAT(ReadError(), HasSubstr("sensor 0: its <resolution> has no width in pixels"));
  Write("<document><chunk></chunk></document>");
  EXPECT_THAT(ReadError(), HasSubstr("has no camera with a pose"));
  WriteWith("label=\"001\"", "label=\"\"");
  EXPECT_THAT(ReadError(), HasSubstr("its photo 2 has no name"));
}

TEST_F(MetashapeTest, WarnsOfShear) {
  Write(MetashapeXml(truth_, "<b2>9</b2>"));
  Read();
  EXPECT_THAT(events_.warnings, Contains(HasSubstr("b2, which no camera model has, is left out")));
}

}  // namespace
}  // namespace oraclegs
