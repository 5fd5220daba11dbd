#include "oraclegs/depth/plane_search.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"
#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

bool SameMap(const PlaneMap& a, const PlaneMap& b) {
  const auto same = [](const Plane& p, const Plane& q) {
    return p.inv_depth == q.inv_depth && p.dx == q.dx && p.dy == q.dy;
  };
  return a.width == b.width && a.height == b.height && a.costs == b.costs &&
         std::equal(a.planes.begin(), a.planes.end(), b.planes.begin(), b.planes.end(), same);
}

std::vector<PlaneMap> Start(const StereoScene& scene) {
  std::vector<PlaneMap> maps;
  for (size_t v = 0; v < scene.views.size(); ++v) maps.push_back(RandomPlanes(scene, v, {}));
  return maps;
}

TEST(CpuPlaneSearch, RunsPassOverAllViews) {
  const StereoScene scene = SceneOf(TakeAll(kSteep, Arc(3, 8, 48, 36)), kSteepRange);
  std::vector<PlaneMap> maps = Start(scene);
  const auto search = MakePlaneSearch(kCpu);
  search->BeginLevel(scene, maps);
  for (const SearchPass& pass : {SearchPass{2, 0, false}, SearchPass{1, 1, true, true}}) {
    search->BeginPass(pass);
    for (size_t v = 0; v < maps.size(); ++v) search->Improve(v);
  }
  for (size_t v = 0; v < maps.size(); ++v) RunPass(scene, v, {2, 0, nullptr}, &maps[v]);
  const std::vector<PlaneMap> before = maps;  // of all views, though some are improved before others
  for (size_t v = 0; v < maps.size(); ++v) RunPass(scene, v, {1, 1, &before, true}, &maps[v]);
  const std::vector<PlaneMap> found = search->EndLevel();
  ASSERT_EQ(found.size(), 3u);
  for (size_t v = 0; v < maps.size(); ++v) EXPECT_TRUE(SameMap(found[v], maps[v])) << v;
}

TEST(CpuPlaneSearch, DropsPreviousLevel) {
  const StereoScene large = SceneOf(TakeAll(kSteep, Arc(3, 8, 48, 36)), kSteepRange),
                    small = SceneOf(TakeAll(kSteep, Arc(2, 8, 24, 18)), kSteepRange);
  const auto search = MakePlaneSearch(kCpu);
  search->BeginLevel(large, Start(large));
  search->BeginPass({1, 0, true});
  search->Improve(0);
  search->BeginLevel(small, Start(small));
  const std::vector<PlaneMap> maps = search->EndLevel();
  ASSERT_EQ(maps.size(), 2u);
  EXPECT_TRUE(SameMap(maps[1], RandomPlanes(small, 1, {})));
}

TEST(MakePlaneSearch, NeedsTheLibraryOfDeviceCodeForAGpu) {
  if (HasCudaLibrary()) GTEST_SKIP() << "which this build has";
  EXPECT_THROW(MakePlaneSearch({DeviceKind::kCuda, 3}), UsageError);
}

}  // namespace
}  // namespace oraclegs
