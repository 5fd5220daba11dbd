#include "oraclegs/propose/warp_device.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"
#include "oraclegs/core/config.h"
#include "oraclegs/core/error.h"
#include "oraclegs/propose/warp.h"

namespace oraclegs {
namespace {

#if !defined(ORACLEGS_CUDA)
TEST(MakeWarpDevice, RefusesGpuWithoutCuda) {
  const std::vector<LoadedView> views;
  const std::vector<DepthMap> maps;
  EXPECT_THROW(MakeWarpDevice({DeviceKind::kCuda, 0}, {views, maps}), UsageError);
}
#endif

TEST(Warper, RefusesImagesOfDifferentSizes) {
  const TexturedPlane plane;
  std::vector<LoadedView> views = TakeAll(plane, Arc(2, 8, 12, 8));
  std::vector<DepthMap> maps = {TrueDepth(views[0], plane, 0.9f), TrueDepth(views[1], plane, 0.9f)};
  EXPECT_NO_THROW(Warper({views, maps}));
  EXPECT_THROW(Warper({views, maps, {Eigen::Vector3f::Ones()}}), ShapeError);
  views[1].mask.assign(95, 1);
  EXPECT_THROW(Warper({views, maps}), ShapeError);
  views.pop_back();
  EXPECT_THROW(Warper({views, maps}), ShapeError);
}

TEST(SurfaceAmong, FindsNoneWithoutSamplesOrVotes) {
  const WarpScene scene{nullptr, 0, 4, 4, 4, 4, 2, 2, {}, false, 0, 0};
  struct NoVotes {
    void Count(const WarpSample*, const WarpSample*) {}
    float Of(int) const { return 0; }
  };
  EXPECT_EQ(SurfaceAmong(scene, 0, nullptr, 0, NoVotes()), 0.f);
  WarpSample one{0.5f, 0, 65535};
  EXPECT_EQ(SurfaceAmong(scene, 0, &one, 1, NoVotes()), 0.f);  // nobody votes
}

}  // namespace
}  // namespace oraclegs
