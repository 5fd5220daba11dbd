#include "oraclegs/scene/capture_layout.h"

#include "scene/tiny_scenes.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

TEST(FindCaptureLayout, KnowsPrograms) {
  const struct {
    const char* program;
    std::vector<const char*> files;
    const char *photos, *poses;
  } layouts[] = {
      {"Polycam", {"keyframes/images/1.jpg", "keyframes/cameras/1.json"}, "keyframes/images", "keyframes/cameras"},
      {"Polycam",
       {"keyframes/images/1.jpg", "keyframes/corrected_images/1.jpg", "keyframes/corrected_cameras/1.json"},
       "keyframes/corrected_images",
       "keyframes/corrected_cameras"},
      {"Polycam", {"images/1.jpg", "cameras/1.json", "confidence/1.png", "depth/1.png"}, "images", "cameras"},
      {"Record3D", {"rgbd/0.jpg", "rgbd/0.depth", "metadata.json"}, "rgbd", "metadata.json"},
      {"ScanNet", {"color/0.jpg", "depth/0.png", "pose/0.txt"}, "color", "pose"},
      {"ARKitScenes",
       {"lowres_wide/1.png", "lowres_depth/1.png", "lowres_wide.traj"},
       "lowres_wide",
       "lowres_wide.traj"},
      {"an RGB-D camera", {"rgb/1.png", "depth/1.png"}, "rgb", ""}};
  for (const auto& [program, files, photos, poses] : layouts) {
    const TempDir dir;
    for (const char* file : files) WriteText(dir / file, "x");
    const auto layout = FindCaptureLayout(dir.path());
    ASSERT_TRUE(layout) << program << " " << photos;
    EXPECT_EQ(layout->program, program);
    EXPECT_EQ(layout->photos, dir / photos);
    EXPECT_EQ(layout->poses, poses);
    EXPECT_EQ(DescribeUnreadPoses(*layout).empty(), layout->poses.empty());
  }
}

TEST(FindCaptureLayout, KnowsNothingElse) {
  const TempDir dir;
  EXPECT_FALSE(FindCaptureLayout(dir.path()));
  EXPECT_FALSE(FindCaptureLayout(dir / "missing"));
  for (const char* file : {"images/1.jpg", "color/1.jpg", "keyframes/notes.txt", "metadata.json"})
    WriteText(dir / file, "x");
  EXPECT_FALSE(FindCaptureLayout(dir.path()));
}

TEST(DescribeUnreadPoses, NamesFilesOfPrograms) {
  const struct {
    const char *file, *text, *program;
  } files[] = {{"export.xml", "<document version=\"2\"><chunk><cameras next_id=\"3\">", " of Metashape"},
               {"cams.csv", "#name,x,y,alt,heading,pitch,roll\n", " of RealityScan"},
               {"IMG_1.xmp", "xmlns:xcr=\"http://www.capturingreality.com/ns/xcr/1.1#\"", " of RealityScan"},
               {"frame_00000.json", "{\"cameraPoseARFrame\": []}", " of 3D Scanner App"},
               {"poses_bounds.npy", "", " of LLFF"},
               {"reconstruction.json", "[{\"cameras\": {}, \"shots\": {}}]", " of OpenSfM"},
               {"opensfm/reconstruction.json", "[{\"shots\": {}}]", " of OpenDroneMap"},
               {"traj.txt", "0 0 0", ""}};
  for (const auto& [file, text, program] : files) {
    const TempDir dir;
    WriteText(dir / file, text);
    EXPECT_THAT(DescribeUnreadPoses(dir.path()),
                HasSubstr(std::string(file) + " has poses" + program + ", which are not read: "))
        << file;
  }
}

TEST(DescribeScenePoses, NamesWhatAloneWouldBeRead) {
  for (const char* place : {"sparse/0", "model", "a/sparse", "a/0"}) {
    const TempDir dir;
    EXPECT_EQ(DescribeScenePoses(dir.path()), "");
    WriteTinyModel(dir / place);
    EXPECT_THAT(DescribeScenePoses(dir.path()), HasSubstr(std::string(place) + " has poses of COLMAP")) << place;
    EXPECT_EQ(DescribeUnreadPoses(dir.path()), "");
  }
  for (const char* file : {"transforms.json", "sub/transforms_train.json"}) {
    const TempDir dir;
    WriteText(dir / file, "{}");
    EXPECT_THAT(DescribeScenePoses(dir.path()), HasSubstr(std::string(file) + " has poses, which are not read"))
        << file;
  }
}

TEST(DescribeUnreadPoses, IsSilentWithoutAny) {
  const TempDir dir;
  for (const char* file : {"settings.xml", "table.csv", "IMG_1.xmp", "notes.json", ".poses.txt", "cameras.xml/x"})
    WriteText(dir / file, "<x:xmpmeta/>");
  EXPECT_EQ(DescribeUnreadPoses(dir.path()), "");
  EXPECT_EQ(DescribeUnreadPoses(dir / "missing"), "");
}

}  // namespace
}  // namespace oraclegs
