#include "oraclegs/depth/fusion.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

/// Views of one plane, whose depth is known except for a square in the middle of each.
class FillPlanesTest : public testing::Test {
 protected:
  void SetUp() override {
    views = TakeAll(kSlanted, Arc(3, 6));
    for (const LoadedView& view : views) {
      maps.push_back(TrueDepth(view, kSlanted, 0.9f));
      for (int y = 25; y < 47; ++y) {
        for (int x = 36; x < 60; ++x) Forget(&maps.back(), static_cast<size_t>(y) * 96 + static_cast<size_t>(x));
      }
    }
    points = FuseDepth(maps, views, {});
  }
  static void Forget(DepthMap* map, size_t i) {
    map->inv_depth[i] = map->confidence[i] = 0;
    map->normals[i].setZero();
  }
  std::vector<DensePoint> Fill() const { return FillPlanes(maps, views, points, {}); }

  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  std::vector<DensePoint> points;
};

TEST_F(FillPlanesTest, FillsHoleOnPlaneOnce) {
  const std::vector<DensePoint> filled = Fill();
  EXPECT_GT(filled.size(), 60u) << "a quarter of the pixels that no view knows";
  EXPECT_LT(filled.size(), 3 * 22 * 24 / 4u) << "what one view has filled the others do not fill again";
  for (const DensePoint& p : filled) {
    EXPECT_LT(std::abs((p.xyz.cast<double>() - kSlanted.point).dot(kSlanted.normal)), 0.01);
    EXPECT_GT(p.normal.cast<double>().dot(kSlanted.normal), 0.99) << "towards the cameras";
    EXPECT_EQ(p.confidence, 0);
    EXPECT_EQ(p.views, 1);
    EXPECT_GT(p.pixel_size, 0);
  }
}

TEST_F(FillPlanesTest, SkipsWhereColorsDiffer) {
  for (size_t v = 0; v < 3; ++v) {
    for (float& value : views[v].rgb.data) value = 0.2f * value + 0.4f * static_cast<float>(v);
  }
  EXPECT_TRUE(Fill().empty());
}

TEST_F(FillPlanesTest, SkipsWhatHasTheColorOfNoKnownPixel) {
  // The hole is painted alike in all views, so that it looks consistent; but nothing around says where it lies.
  for (size_t v = 0; v < views.size(); ++v) {
    for (size_t i = 0; i < maps[v].size(); ++i) {
      if (maps[v].confidence[i] > 0) continue;
      float* rgb = views[v].rgb.data.data() + 3 * i;
      rgb[0] = 0, rgb[1] = 1, rgb[2] = 0;
    }
  }
  EXPECT_TRUE(Fill().empty());
}

TEST_F(FillPlanesTest, SkipsWhereKnownPixelsOfTheColorLieOnNoPlane) {
  // Leaves: of one color, each at a distance of its own; the plane's points are those of the depth before.
  for (DepthMap& map : maps) {
    for (size_t i = 0; i < map.size(); ++i) map.inv_depth[i] *= 0.5f + 0.01f * static_cast<float>(i * 2654435761u % 97);
  }
  EXPECT_TRUE(Fill().empty());
}

/// One view of a white wall at z = 3, and of a green lawn at z = 5 in the right third, part of which has no depth.
TEST(FillPlanes, ContinuesThePlaneOfTheColorAndNotThatOfTheMost) {
  LoadedView view;
  view.camera = CameraAt({0, 0, 0}, {0, 0, 1}, 96, 72);
  view.rgb = ImageF{96, 72, 3, {}};
  DepthMap map{"a.png", view.camera, {}, {}, {}};
  std::vector<DensePoint> points;
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      const bool is_lawn = x >= 64, is_known = !is_lawn || y < 24;
      const float z = is_lawn ? 5 : 3;
      const Eigen::Vector3f color = is_lawn ? Eigen::Vector3f(0.3f, 0.6f, 0.1f) : Eigen::Vector3f(0.9f, 0.9f, 0.9f);
      view.rgb.data.insert(view.rgb.data.end(), color.begin(), color.end());
      map.inv_depth.push_back(is_known ? 1 / z : 0), map.confidence.push_back(is_known ? 0.9f : 0);
      map.normals.emplace_back(0, 0, is_known ? -1 : 0);
      if (!is_known) continue;
      const Eigen::Vector3f xyz = z * RayOf(view.camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      points.push_back({xyz, {0, 0, -1}, color, 0.9f, z / static_cast<float>(view.camera.fx), 0, 1});
    }
  }
  const std::vector<DensePoint> filled = FillPlanes({map}, {view}, points, {});
  EXPECT_GT(filled.size(), 150u) << "the lattice has 384 points there";
  for (const DensePoint& p : filled) EXPECT_NEAR(p.xyz.z(), 5, 0.01);
}

TEST_F(FillPlanesTest, SkipsWhereSeenThrough) {
  for (float& w : maps[1].inv_depth) w *= 0.5f;  // it saw a surface twice as far
  for (size_t v : {0u, 2u}) {
    for (size_t i = 0; i < maps[1].size(); ++i) {
      if (maps[1].confidence[i] == 0) maps[1].confidence[i] = 0.9f, maps[1].inv_depth[i] = 0.1f;
    }
    for (const DensePoint& p : FillPlanes({maps[v], maps[1]}, {views[v], views[1]}, points, {})) {
      const Eigen::Vector3d there = views[1].camera.cam_from_world * p.xyz.cast<double>();
      const double x = views[1].camera.fx * there.x() / there.z() + views[1].camera.cx;
      const double y = views[1].camera.fy * there.y() / there.z() + views[1].camera.cy;
      EXPECT_TRUE(x < 0 || y < 0 || x >= 96 || y >= 72) << "view 1 is sure of a farther surface everywhere";
    }
  }
}

TEST_F(FillPlanesTest, IgnoresMaskedPixelsOfOtherViews) {
  const size_t before = Fill().size();
  for (size_t v = 1; v < 3; ++v) {
    for (float& value : views[v].rgb.data) value = 0.2f * value + 0.7f;  // another color, but nobody looks there
    views[v].mask.assign(maps[v].size(), 0);
  }
  EXPECT_GT(Fill().size(), before / 2);
}

TEST_F(FillPlanesTest, LeavesMaskedPixelsEmpty) {
  for (LoadedView& view : views) view.mask.assign(maps[0].size(), 0);
  EXPECT_TRUE(Fill().empty());
}

TEST_F(FillPlanesTest, GivesSameBitsForAnyThreads) {
  const std::vector<DensePoint> before = Fill();
  SetNumThreads(1);
  const std::vector<DensePoint> after = Fill();
  SetNumThreads(0);
  ASSERT_EQ(before.size(), after.size());
  for (size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before[i].xyz, after[i].xyz);
}

TEST_F(FillPlanesTest, IsEmptyWithoutMapsOrPlanes) {
  EXPECT_TRUE(FillPlanes({}, {}, points, {}).empty());
  EXPECT_TRUE(FillPlanes(maps, views, {}, {}).empty());
}

}  // namespace
}  // namespace oraclegs
