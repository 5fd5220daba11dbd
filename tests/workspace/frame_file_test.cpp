#include "oraclegs/workspace/frame_file.h"

#include <gtest/gtest.h>

#include "oraclegs/core/files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

class FrameFileTest : public testing::Test {
 protected:
  FrameFileTest() {
    for (int i = 0; i < 4; ++i) {
      SceneView view;
      view.name = std::to_string(i);
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = Eigen::AngleAxisd(0.4 * i + 0.1, Eigen::Vector3d(0.2, 1, 0).normalized()).toRotationMatrix();
      pose.translation() = Eigen::Vector3d(0.1 * i, 0, 3);
      view.cam_from_world = pose;
      scene.views.push_back(view);
    }
  }

  TempDir temp;
  Scene scene;
};

TEST_F(FrameFileTest, KeepsTheFrameOfTheSamePoses) {
  SceneFrame frame = FrameOf(scene, temp / "frame.json");
  EXPECT_EQ(frame.rotation, LevelFrame(scene).rotation) << "there is none yet";
  frame.scale *= 2;  // as another version would choose it
  WriteFrame(scene, frame, temp / "frame.json");
  const SceneFrame again = FrameOf(scene, temp / "frame.json");
  EXPECT_EQ(again.rotation, frame.rotation);
  EXPECT_EQ(again.center, frame.center);
  EXPECT_EQ(again.scale, frame.scale);
  EXPECT_TRUE(again.is_level);
  frame.is_given = true, frame.offset = {1e6, -2, 0.5};
  WriteFrame(scene, frame, temp / "given.json");
  const auto given = ReadFrame(temp / "given.json");
  ASSERT_TRUE(given);
  EXPECT_TRUE(given->is_given && !given->is_level);
  EXPECT_EQ(given->offset, frame.offset);
  scene.views[0].cam_from_world->translation().x() += 1;
  EXPECT_NE(FrameOf(scene, temp / "frame.json").scale, frame.scale) << "poses were found anew";
}

TEST_F(FrameFileTest, IgnoresDamage) {
  EXPECT_FALSE(ReadFrame(temp / "missing.json"));
  for (const char* text : {"", "{", "[]", R"({"rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "center": [0, 0, 0]})",
                           R"({"rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "center": [0, 0, 0], "scale": 0})",
                           R"({"rotation": [2, 0, 0, 0, 1, 0, 0, 0, 1], "center": [0, 0, 0], "scale": 1})",
                           R"({"rotation": [1, 0, 0, 0, 1, 0, 0, 0, "x"], "center": [0, 0, 0], "scale": 1})"}) {
    WriteText(temp / "frame.json", text);
    EXPECT_FALSE(ReadFrame(temp / "frame.json")) << text;
  }
  WriteText(temp / "frame.json", R"({"rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "center": [0, 0, 0], "scale": 1})");
  EXPECT_TRUE(ReadFrame(temp / "frame.json"));
}

}  // namespace
}  // namespace oraclegs
