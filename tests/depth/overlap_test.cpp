#include "oraclegs/depth/overlap.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

/// A camera at (x, 0, 0) that looks along z, with the depth of a wall at z = 4, confident in the left `confident`
/// columns.
void AddView(double x, int confident, std::vector<DepthMap>* maps, std::vector<LoadedView>* views) {
  DepthMap map;
  map.camera = {64, 48, 64, 64, 32, 24};
  map.camera.cam_from_world.translation() = Eigen::Vector3d(-x, 0, 0);
  map.inv_depth.assign(64 * 48, .25f);
  map.confidence.assign(64 * 48, .1f);
  for (int p = 0; p < 64 * 48; ++p) {
    if (p % 64 < confident) map.confidence[static_cast<size_t>(p)] = .9f;
  }
  LoadedView view;
  view.camera = map.camera;
  view.rgb = {64, 48, 3, std::vector<float>(64 * 48 * 3)};
  for (size_t i = 0; i < view.rgb.data.size(); ++i) view.rgb.data[i] = static_cast<float>(i * 7919 % 101) / 100;
  maps->push_back(std::move(map));
  views->push_back(std::move(view));
}

TEST(MeasureOverlap, CountsWhatTheOtherViewSees) {
  std::vector<DepthMap> maps;
  std::vector<LoadedView> views;
  AddView(0, 64, &maps, &views);
  AddView(2, 0, &maps, &views);  // moved by 32 of 64 pixels
  const Overlap overlap = MeasureOverlap(maps, views, Silhouettes(views));
  EXPECT_NEAR(overlap.seen, .5, 1e-9);
  EXPECT_NEAR(overlap.confident, .5, 1e-9) << "all of one view, none of the other";
}

TEST(MeasureOverlap, NeedsParallaxButNotTooMuch) {
  for (const double x : {.01, 40.}) {
    std::vector<DepthMap> maps;
    std::vector<LoadedView> views;
    AddView(0, 64, &maps, &views);
    AddView(x, 64, &maps, &views);
    EXPECT_EQ(MeasureOverlap(maps, views, Silhouettes(views)).seen, 0) << x;
  }
}

TEST(MeasureOverlap, LeavesOutMaskedPixels) {
  std::vector<DepthMap> maps;
  std::vector<LoadedView> views;
  AddView(0, 64, &maps, &views);
  AddView(2, 64, &maps, &views);
  for (LoadedView& view : views) view.mask.assign(64 * 48, 0);
  EXPECT_EQ(MeasureOverlap(maps, views, Silhouettes({})).seen, 0);
  for (int p = 0; p < 64 * 48; ++p) views[0].mask[static_cast<size_t>(p)] = p % 64 >= 32;  // what view 1 shows, too
  EXPECT_NEAR(MeasureOverlap(maps, views, Silhouettes({})).seen, 1, 1e-9);
  EXPECT_EQ(MeasureOverlap({}, {}, Silhouettes({})).seen, 0);
}

}  // namespace
}  // namespace oraclegs
