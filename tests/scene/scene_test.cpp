#include "oraclegs/scene/scene.h"

#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {
using ::testing::ElementsAre;
using ::testing::HasSubstr;

SceneView View(const std::string& name, const std::string& image_path) {
  SceneView view;
  view.name = name;
  view.image_path = image_path;
  return view;
}

TEST(AllViews, ListsIndices) {
  Scene scene;
  EXPECT_TRUE(AllViews(scene).empty());
  scene.views.resize(3);
  EXPECT_THAT(AllViews(scene), ElementsAre(0, 1, 2));
}

TEST(ViewName, StaysInsideAFolder) {
  EXPECT_EQ(ViewName("./train/r_0.png"), "train/r_0.png");
  EXPECT_EQ(ViewName("a.png"), "a.png");
  EXPECT_EQ(ViewName("../../x/./y.png"), "x/y.png");
  EXPECT_EQ(ViewName("/etc/a.png"), "etc/a.png");
  EXPECT_EQ(ViewName("a//b.png"), "a/b.png");
  EXPECT_EQ(ViewName(".."), "");
}

TEST(RequireUtf8Names, NamesTheFile) {
  Scene scene;
  scene.root = "/scene";
  scene.views = {View("caf\xC3\xA9.jpg", "/scene/caf\xC3\xA9.jpg")};
  EXPECT_NO_THROW(RequireUtf8Names(scene));
  scene.missing_images = {"b\xFF.jpg"};
  EXPECT_THAT(MessageOf<InputError>([&] { RequireUtf8Names(scene); }), HasSubstr("/scene/b\\xFF.jpg: "));
  scene.views.push_back(View("caf\xE9.jpg", "/scene/caf\xE9.jpg"));
  EXPECT_THAT(MessageOf<InputError>([&] { RequireUtf8Names(scene); }), HasSubstr("/scene/caf\\xE9.jpg: "));
}

TEST(KeepViewsWithImages, SortsByName) {
  Scene scene;
  EventRecorder events;
  KeepViewsWithImages({View("b", "x"), View("a10", "x"), View("a9", ""), View("B", "x")}, "FILE", "FOLDER",
                      events.AsListener(), &scene);
  ASSERT_EQ(scene.views.size(), 3u);
  EXPECT_EQ(scene.views[0].name, "B");
  EXPECT_EQ(scene.views[1].name, "a10");
  EXPECT_EQ(scene.views[2].name, "b");
  EXPECT_THAT(scene.missing_images, ElementsAre("a9"));
  EXPECT_THAT(events.warnings, ElementsAre("FILE: 1 of 4 views have no image file in FOLDER and are left out: a9"));
}

TEST(KeepViewsWithImages, RefusesDuplicatesAndNoViews) {
  Scene scene;
  EXPECT_THAT(MessageOf<InputError>([&] {
                KeepViewsWithImages({View("a", "x"), View("a", "")}, "FILE", "F", Silent(), &scene);
              }),
              HasSubstr("FILE: lists the view 'a' twice"));
  EXPECT_THAT(MessageOf<InputError>([&] { KeepViewsWithImages({View("a", "")}, "FILE", "FOLDER", Silent(), &scene); }),
              HasSubstr("in FOLDER, e.g. a"));
}

TEST(AttachMasks, FindsMasksByName) {
  TempDir dir;
  for (const char* name : {"as_is.png", "appended.jpg.png", "replaced.png", "sub/x.png"}) WriteText(dir / name, "mask");
  Scene scene;
  for (const char* name : {"as_is.png", "appended.jpg", "replaced.jpg", "images/sub/x.jpg", "none.jpg"}) {
    scene.views.push_back(View(name, "x"));
  }
  scene.views.push_back(View("given.png", "x"));
  scene.views.back().mask_path = "given";
  EventRecorder events;
  AttachMasks(dir.path(), events.AsListener(), &scene);
  EXPECT_EQ(scene.views[0].mask_path, dir / "as_is.png");
  EXPECT_EQ(scene.views[1].mask_path, dir / "appended.jpg.png");
  EXPECT_EQ(scene.views[2].mask_path, dir / "replaced.png");
  EXPECT_EQ(scene.views[3].mask_path, dir / "sub/x.png");
  EXPECT_TRUE(scene.views[4].mask_path.empty());
  EXPECT_EQ(scene.views[5].mask_path, "given");
  EXPECT_TRUE(events.warnings.empty());
}

TEST(AttachMasks, FoldsNames) {
  TempDir dir;
  for (const char* name : {"Img_1.PNG", "b.jpeg", "c.jpg.WEBP", "d.tif", "d.webp"}) WriteText(dir / name, "mask");
  Scene scene;
  for (const char* name : {"images/IMG_1.JPG", "b.jpg", "c.jpg", "d.jpg"}) scene.views.push_back(View(name, "x"));
  AttachMasks(dir.path(), Silent(), &scene);
  EXPECT_EQ(scene.views[0].mask_path, dir / "Img_1.PNG");
  EXPECT_EQ(scene.views[1].mask_path, dir / "b.jpeg");
  EXPECT_EQ(scene.views[2].mask_path, dir / "c.jpg.WEBP");
  EXPECT_TRUE(scene.views[3].mask_path.empty());  // either could be meant
}

TEST(AttachMasks, WarnsOfAFolderThatFitsNoView) {
  TempDir dir;
  Scene scene;
  scene.views.push_back(View("a.jpg", "x"));
  EventRecorder events;
  AttachMasks(dir / "absent", events.AsListener(), &scene);
  EXPECT_TRUE(events.warnings.empty());
  AttachMasks(dir.path(), events.AsListener(), &scene);
  ASSERT_EQ(events.warnings.size(), 1u);
  EXPECT_THAT(events.warnings[0], HasSubstr("fits no view"));
}

TEST(PointPly, HoldsPositionsAndColors) {
  const TempDir temp;
  WritePointPly(temp / "points.ply", {{{1, -2.5, 1e-7}, {255, 0, 7}, {}}, {{0, 0, 3}, {1, 2, 3}, {0, 1}}});
  EXPECT_EQ(ReadFile(temp / "points.ply"),
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
            "1 -2.5 1e-07 255 0 7\n0 0 3 1 2 3\n");
}

TEST(PointPly, NamesThePlaceThatCannotBeWritten) {
  const TempDir temp;
  WriteText(temp / "file", "no folder");
  EXPECT_THROW(WritePointPly(temp / "file" / "points.ply", {}), RunError);
}

TEST(FileNames, AreFlatAndUnique) {
  EXPECT_EQ(FileName("left/0001.jpg"), "left_0001");
  EXPECT_EQ(FileName("orbit_0001"), "orbit_0001");
  EXPECT_EQ(FileName("../a.v2"), "a.v2");
  EXPECT_EQ(FileName(".."), "view");
  EXPECT_THAT(FileNames({"a/b.jpg", "a_b.png", "a_b_2", "c", "c"}), ElementsAre("a_b", "a_b_3", "a_b_2", "c", "c_2"));
}

}  // namespace
}  // namespace oraclegs
