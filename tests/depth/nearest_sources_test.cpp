#include "oraclegs/depth/nearest_sources.h"

#include <gmock/gmock.h>

#include "depth/rig.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const TexturedPlane kSourcesWall{{0, 0, 0}, {0, 0, -1}};

DepthMap SourceMapOf(const Camera& camera) {
  DepthMap map{"", camera, {}, {}, {}};
  for (int i = 0; i < camera.width * camera.height; ++i) {
    map.inv_depth.push_back(
        static_cast<float>(1 / kSourcesWall.DepthAt(camera, i % camera.width + 0.5, i / camera.width + 0.5)));
    map.confidence.push_back(1);
  }
  return map;
}

/// A camera before the wall, at x, that looks straight at it.
Camera Before(double x) { return CameraAt({x, 0, -4}, {x, 0, 0}); }

std::vector<DepthMap> MapsAt(const std::vector<double>& places) {
  std::vector<DepthMap> maps;
  for (const double x : places) maps.push_back(SourceMapOf(Before(x)));
  return maps;
}

TEST(NearestSourcesTest, AreThoseBesideThePose) {
  const NearestSources sources(MapsAt({3, 0, 1, -2, 6, .5}));
  EXPECT_THAT(sources.For(Before(.2), 2), ElementsAre(1, 5));
  EXPECT_THAT(sources.For(Before(0), 2, 1), ElementsAre(2, 5));
}

TEST(NearestSourcesTest, PreferTheDirectionOfThePose) {
  std::vector<DepthMap> maps;
  for (const double x : {-6., 0.5, 6.}) maps.push_back(SourceMapOf(CameraAt({x, 0, -4}, {0, 0, 0})));
  EXPECT_THAT(NearestSources(maps).For(CameraAt({5, 0, -4}, {0, 0, 0}), 1), ElementsAre(2));
}

TEST(NearestSourcesTest, AreAllWhereThereAreFew) {
  const NearestSources sources(MapsAt({0, 100, 200}));
  EXPECT_THAT(sources.For(Before(0), 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(sources.For(Before(0), 2, 0), ElementsAre(1, 2));
}

TEST(NearestSourcesTest, HaveDepth) {
  std::vector<DepthMap> maps = MapsAt({0, .1, .2});
  maps[1] = {"", maps[1].camera, {}, {}, {}};
  EXPECT_THAT(NearestSources(maps).For(Before(0), 8), ElementsAre(0, 2));
  EXPECT_THAT(NearestSources().For(Before(0), 8), IsEmpty());
}

}  // namespace
}  // namespace oraclegs
