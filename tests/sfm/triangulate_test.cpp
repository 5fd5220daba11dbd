#include "oraclegs/sfm/register_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/sfm/colmap_runner.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// An environment without programs.
class EmptyPath {
 public:
  EmptyPath() : old_(std::getenv("PATH")) { setenv("PATH", "/nowhere", 1); }
  ~EmptyPath() { setenv("PATH", old_.c_str(), 1); }

 private:
  std::string old_;
};

TEST(TriangulatePoints, FindsAndCachesPointsOnThePlanes) {
  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir / "scene", 5);
  const std::vector<int> views{0, 1, 3, 4};  // index 2 is held out
  EventRecorder events;
  const auto points = TriangulatePoints(scene, views, {dir / "sfm"}, events.AsListener());
  ASSERT_GT(points.size(), 100u);
  EXPECT_THAT(events.warnings, testing::IsEmpty());
  size_t off = 0;
  int on_wall = 0, on_shelf = 0;
  for (const ScenePoint& point : points) {
    const double to_wall = std::abs(point.xyz.z() - kWallDepth), to_shelf = std::abs(point.xyz.z() - kShelfDepth);
    off += std::min(to_wall, to_shelf) > .08;
    ++(to_wall < to_shelf ? on_wall : on_shelf);
    ASSERT_GE(point.views.size(), 2u);
    for (const int v : point.views) ASSERT_TRUE(v == 0 || v == 1 || v == 3 || v == 4) << v;
  }
  EXPECT_LT(static_cast<double>(off), .05 * static_cast<double>(points.size()));
  EXPECT_GT(on_wall, 20);
  EXPECT_GT(on_shelf, 20);

  // Again: the same points, and colmap does not run.
  const std::string log = ReadFile(dir / "sfm" / "colmap.log");
  const EmptyPath no_programs;
  const auto again = TriangulatePoints(scene, views, {dir / "sfm"}, events.AsListener());
  ASSERT_EQ(again.size(), points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(again[i].xyz, points[i].xyz);
    ASSERT_EQ(again[i].views, points[i].views);
  }
  EXPECT_EQ(ReadFile(dir / "sfm" / "colmap.log"), log);
  EXPECT_EQ(ReadFile(dir / "sfm" / "points.ply").substr(0, 3), "ply");

  // Other views are other inputs.
  EXPECT_TRUE(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, events.AsListener()).empty());
  EXPECT_THAT(events.warnings, testing::Contains(HasSubstr("colmap program is not installed")));
}

TEST(TriangulatePoints, UsesTheFeaturesOfARegistration) {
  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir / "scene", 4);
  TriangulatePoints(scene, {0, 1, 2, 3}, {dir / "registered"}, Silent());
  const auto points = TriangulatePoints(scene, {0, 1, 3}, {dir / "sfm", dir / "registered"}, Silent());
  ASSERT_GT(points.size(), 100u);
  EXPECT_THAT(ReadFile(dir / "sfm" / "colmap.log"), testing::Not(HasSubstr("Feature extraction")));
  for (const ScenePoint& point : points) EXPECT_THAT(point.views, testing::Not(testing::Contains(2))) << "held out";
}

/// How often colmap looked for features, by its log.
size_t Extractions(const fs::path& work_dir) {
  const std::string log = ReadFile(work_dir / "colmap.log"), title = "Feature extraction";
  size_t times = 0;
  for (size_t at = log.find(title); at != std::string::npos; at = log.find(title, at + 1)) ++times;
  return times;
}

TEST(TriangulatePoints, LooksInManyLargePhotosForFewFeatures) {
  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir / "scene", 8, 4);
  const auto points = TriangulatePoints(scene, {0, 1, 2, 3, 4, 5, 6, 7}, {dir / "sfm"}, Silent());
  EXPECT_GT(points.size(), 800u);
  EXPECT_EQ(Extractions(dir / "sfm"), 1u);
}

TEST(TriangulatePoints, LooksForMoreFeaturesWhereFewAreFound) {
  const TempDir dir;
  Scene scene = WriteTexturedPlanes(dir / "scene", 8);
  for (SceneView& view : scene.views) {  // a small picture with a wide frame
    const Image8 picture = ReadImage(view.image_path);
    Image8 framed{4 * kPlanesWidth, kPlanesHeight, 3, {}};
    framed.data.assign(size_t{3} * 4 * kPlanesWidth * kPlanesHeight, 128);
    for (int y = 0; y < kPlanesHeight; ++y) {
      std::copy_n(picture.data.begin() + int64_t{3} * y * kPlanesWidth, 3 * kPlanesWidth,
                  framed.data.begin() + int64_t{12} * y * kPlanesWidth);
    }
    WritePng(view.image_path, framed);
    view.intrinsics.width = framed.width;
  }
  const auto points = TriangulatePoints(scene, {0, 1, 2, 3, 4, 5, 6, 7}, {dir / "sfm"}, Silent());
  EXPECT_GT(points.size(), 100u);
  EXPECT_EQ(Extractions(dir / "sfm"), 2u);
}

TEST(TriangulatePoints, WarnsWithoutColmap) {
  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir / "scene", 2);
  EventRecorder events;
  const EmptyPath no_programs;
  EXPECT_FALSE(ColmapAvailable());
  EXPECT_TRUE(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, events.AsListener()).empty());
  EXPECT_THAT(events.warnings, testing::Contains(HasSubstr("apt install colmap")));
  EXPECT_FALSE(fs::exists(dir / "sfm"));
}

TEST(TriangulatePoints, WarnsOfAFailure) {
  const TempDir dir;
  fs::create_directories(dir / "bin");
  std::ofstream(dir / "bin" / "colmap") << "#!/bin/sh\necho it broke\nexit 3\n";
  fs::permissions(dir / "bin" / "colmap", fs::perms::owner_all);
  const Scene scene = WriteTexturedPlanes(dir / "scene", 2);
  EventRecorder events;
  const EmptyPath no_programs;
  setenv("PATH", (dir / "bin").c_str(), 1);
  EXPECT_TRUE(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, events.AsListener()).empty());
  EXPECT_THAT(events.warnings, testing::ElementsAre(AllOf(HasSubstr("feature_extractor ended with code 3"),
                                                          HasSubstr("it broke"), HasSubstr("colmap.log"))));
  EXPECT_FALSE(fs::exists(dir / "sfm" / "inputs.json"));

  const std::string log = ReadFile(dir / "sfm" / "colmap.log"), warning = events.warnings[0];
  EXPECT_TRUE(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, events.AsListener()).empty());
  EXPECT_THAT(events.warnings, testing::ElementsAre(warning, warning));
  EXPECT_EQ(ReadFile(dir / "sfm" / "colmap.log"), log) << "it failed on the same images before";

  std::ofstream(dir / "bin" / "colmap") << "#!/bin/sh\necho another one\nexit 4\n";
  EXPECT_TRUE(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, events.AsListener()).empty());
  EXPECT_THAT(events.warnings.back(), HasSubstr("ended with code 4: another one"));

  WriteText(dir / "sfm" / "failure.json", "{\"inputs\":");
  EXPECT_TRUE(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, events.AsListener()).empty());
  EXPECT_THAT(ReadFile(dir / "sfm" / "colmap.log"), HasSubstr("another one"));
}

TEST(TriangulatePoints, GoesOnToFailWhenColmapIsKilled) {
  const TempDir dir;
  fs::create_directories(dir / "bin");
  std::ofstream(dir / "bin" / "colmap") << "#!/bin/sh\nkill -KILL $$\n";
  fs::permissions(dir / "bin" / "colmap", fs::perms::owner_all);
  const Scene scene = WriteTexturedPlanes(dir / "scene", 2);
  const EmptyPath no_programs;
  setenv("PATH", ((dir / "bin").string() + ":/usr/bin:/bin").c_str(), 1);
  EXPECT_THROW(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, Silent()), RunError);
  EXPECT_FALSE(fs::exists(dir / "sfm" / "failure.json"));
}

TEST(TriangulatePoints, TriesAgainWhenColmapCouldNotRun) {
  const TempDir dir;
  fs::create_directories(dir / "bin");
  std::ofstream(dir / "bin" / "colmap") << "#!/bin/sh\necho 'error while loading shared libraries' >&2; exit 127\n";
  fs::permissions(dir / "bin" / "colmap", fs::perms::owner_all);
  const Scene scene = WriteTexturedPlanes(dir / "scene", 2);
  EventRecorder events;
  const EmptyPath no_programs;
  setenv("PATH", ((dir / "bin").string() + ":/usr/bin:/bin").c_str(), 1);
  EXPECT_TRUE(TriangulatePoints(scene, {0, 1}, {dir / "sfm"}, events.AsListener()).empty());
  EXPECT_THAT(events.warnings, testing::ElementsAre(HasSubstr("error while loading shared libraries")));
  EXPECT_FALSE(fs::exists(dir / "sfm" / "failure.json"));
}

TEST(PointsSeenBy, KeepsPointsOfTwoViews) {
  Scene scene;
  scene.points = {{{1, 0, 0}, {}, {0, 1, 2}}, {{2, 0, 0}, {}, {0, 3}}, {{3, 0, 0}, {}, {1, 2}}, {{4, 0, 0}, {}, {}}};
  const auto kept = PointsSeenBy(scene, {0, 2});
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].xyz.x(), 1);
}

}  // namespace
}  // namespace oraclegs
