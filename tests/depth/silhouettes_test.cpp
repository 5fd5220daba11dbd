#include "oraclegs/depth/silhouettes.h"

#include <gtest/gtest.h>

#include "depth/rig.h"

namespace oraclegs {
namespace {

/// A dark disc with a hole of the background's color, at (x, y), before one color.
LoadedView Disc(const Camera& camera, double x, double y, double radius, float background = 1) {
  LoadedView view{"disc", camera, {camera.width, camera.height, 3, {}}, {}};
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double r = std::hypot(u + 0.5 - x, v + 0.5 - y);
      const float value = r < radius && r > 2 ? 0.3f : background;
      view.rgb.data.insert(view.rgb.data.end(), 3, value);
    }
  }
  return view;
}

const Camera kFront = CameraAt({0, 0, -4}, {0, 0, 0}, 96, 72), kSide = CameraAt({4, 0, 0}, {0, 0, 0}, 96, 72);

size_t PixelAt(int x, int y) { return static_cast<size_t>(y) * 96 + static_cast<size_t>(x); }

TEST(Silhouettes, FindObjectBeforePlainBackground) {
  const Silhouettes silhouettes({Disc(kFront, 48, 36, 20), Disc(kSide, 40, 36, 20)});
  ASSERT_FALSE(silhouettes.empty());
  EXPECT_EQ(silhouettes.Object(0)[PixelAt(60, 36)], 1);
  EXPECT_EQ(silhouettes.Object(0)[PixelAt(48, 36)], 1) << "the background's color inside the object is object";
  EXPECT_EQ(silhouettes.Object(0)[PixelAt(5, 5)], 0);
  EXPECT_EQ(silhouettes.Object(0)[PixelAt(65, 36)], 1);
  EXPECT_EQ(silhouettes.Object(1)[PixelAt(65, 36)], 0);
}

TEST(Silhouettes, MayContainAllowsTwoPixels) {
  const Silhouettes silhouettes({Disc(kFront, 48, 36, 20)});
  EXPECT_TRUE(silhouettes.MayContain(0, 67.5f, 36.5f));
  EXPECT_TRUE(silhouettes.MayContain(0, 69.5f, 36.5f));
  EXPECT_FALSE(silhouettes.MayContain(0, 70.5f, 36.5f));
  EXPECT_FALSE(silhouettes.MayContain(0, 0, 0));
  EXPECT_TRUE(silhouettes.MayContain(0, -0.5f, 36));
  EXPECT_TRUE(silhouettes.MayContain(0, 96, 36));
  EXPECT_TRUE(silhouettes.MayContain(0, 40, 1e9f));
}

TEST(Silhouettes, AreMasksWhereMasksDiffer) {
  LoadedView view = TexturedPlane{}.Take(kFront, "busy");
  view.mask.assign(view.rgb.data.size() / 3, 0);
  for (int y = 20; y < 50; ++y) {
    for (int x = 30; x < 60; ++x) view.mask[PixelAt(x, y)] = 1;
  }
  const Silhouettes silhouettes({view});
  ASSERT_FALSE(silhouettes.empty());
  EXPECT_EQ(silhouettes.Object(0), view.mask);
  EXPECT_TRUE(Silhouettes({view, view}).empty()) << "one mask for all is the lens's rim";
}

TEST(Silhouettes, AreNoneWhereOneBorderShowsScene) {
  EXPECT_TRUE(Silhouettes({}).empty());
  EXPECT_TRUE(Silhouettes({TexturedPlane{}.Take(kFront, "busy")}).empty());
  const LoadedView disc = Disc(kFront, 48, 36, 20);
  EXPECT_TRUE(Silhouettes({disc, TexturedPlane{}.Take(kSide, "busy"), disc}).empty());
  EXPECT_TRUE(Silhouettes({disc, disc, Disc(kSide, 48, 36, 20, 0.9f)}).empty()) << "another background";
  EXPECT_TRUE(Silhouettes({disc, Disc(kSide, -9, -9, 3)}).empty()) << "an empty image";
}

TEST(Silhouettes, AllowTenthOfBorder) {
  EXPECT_FALSE(Silhouettes({Disc(kFront, 48, 60, 15)}).empty());
  EXPECT_TRUE(Silhouettes({Disc(kFront, 48, 60, 40)}).empty());
}

TEST(Silhouettes, TolerateSmallColorDifferences) {
  LoadedView view = Disc(kFront, 48, 36, 20, 0.5f);
  for (size_t i = 0; i < view.rgb.data.size(); i += 7) view.rgb.data[i] += 2.f / 255;
  const Silhouettes silhouettes({view});
  ASSERT_FALSE(silhouettes.empty());
  EXPECT_EQ(silhouettes.Object(0), Silhouettes({Disc(kFront, 48, 36, 20, 0.5f)}).Object(0));
}

}  // namespace
}  // namespace oraclegs
