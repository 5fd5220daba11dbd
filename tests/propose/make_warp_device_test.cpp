#include "oraclegs/propose/warp_device.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"
#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/error.h"
#include "oraclegs/propose/warp.h"

namespace oraclegs {
namespace {

TEST(MakeWarpDevice, NeedsTheLibraryOfDeviceCodeForAGpu) {
  if (HasCudaLibrary()) GTEST_SKIP() << "which this build has";
  const std::vector<LoadedView> views;
  const std::vector<DepthMap> maps;
  EXPECT_THROW(MakeWarpDevice({DeviceKind::kCuda, 0}, {views, maps}), UsageError);
}

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

TEST(SurfaceAmong, KeepsAnOnlySurfaceUnlessTheViewsThatSeeThroughItWeighMore) {
  const std::vector<float> same(16, 0.5f), farther(16, 0.25f), unknown(16, 0.f), sure(16, 1.f);
  const auto keeps = [&](float vote, const std::vector<float>& of_other) {
    std::vector<WarpSource> sources(2);
    for (WarpSource& source : sources) {
      source.inv_depth = same.data(), source.confidence = sure.data();
      source.width = source.height = 4;
      source.focal = 4;
      source.to_new = source.from_new = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
    }
    sources[1].inv_depth = of_other.data();
    struct FirstVotes {
      float vote;
      void Count(const WarpSample*, const WarpSample*) {}
      float Of(int source) const { return source == 0 ? vote : 0; }
    };
    const WarpScene scene{sources.data(), 2, 4, 4, 4, 4, 2, 2, {}, false, 0, 0};
    WarpSample one{0.5f, 0, 65535};
    return SurfaceAmong(scene, 5, &one, 1, FirstVotes{vote}) == 0.5f;
  };
  for (const float vote : {0.1f, 0.2f}) {
    EXPECT_TRUE(keeps(vote, same));
    EXPECT_TRUE(keeps(vote, unknown));
  }
  EXPECT_FALSE(keeps(0.1f, farther));  // a view that sees through it subtracts .15
  EXPECT_TRUE(keeps(0.2f, farther));
}

}  // namespace
}  // namespace oraclegs
