#include "oraclegs/propose/warp_device.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

TEST(WarpDevice, NoOtherDeviceStandsInForOneThatCannotBeUsed) {
  const std::vector<LoadedView> photos;
  const std::vector<DepthMap> maps;
  EXPECT_THROW(MakeWarpDevice(Device(torch::kXLA), {photos, maps}), UsageError);
}

TEST(WarpDevice, RefusesPicturesOfDifferentSizes) {
  const TexturedPlane plane;
  std::vector<LoadedView> photos = TakeAll(plane, Arc(2, 8, 12, 8));
  std::vector<DepthMap> maps = {TrueDepth(photos[0], plane, 0.9f), TrueDepth(photos[1], plane, 0.9f)};
  EXPECT_NO_THROW(Warper({photos, maps}));
  EXPECT_THROW(Warper({photos, maps, {Eigen::Vector3f::Ones()}}), ShapeError);
  photos[1].mask.assign(95, 1);
  EXPECT_THROW(Warper({photos, maps}), ShapeError);
  photos.pop_back();
  EXPECT_THROW(Warper({photos, maps}), ShapeError);
}

TEST(WarpDevice, WithoutSamplesOrVotesThereIsNoSurface) {
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
