#include "oraclegs/mesh/tsdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/views_of_shapes.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

TEST(TsdfVolume, HoldsTheDistanceToAPlane) {
  constexpr double kVoxel = 0.05, kTruncation = 0.2, kHeight = 0.13;
  TsdfBlocks blocks(kVoxel, kTruncation);
  std::vector<SurfaceView> views;
  for (const double x : {-0.7, 0.0, 0.6}) {
    views.push_back(ViewOfShape(FloorAt(kHeight), ShapeCamera({x, 0.3, 2}, {0, 0, kHeight})));
    blocks.Add(views.back());
  }
  TsdfVolume volume(blocks);
  for (const SurfaceView& view : views) volume.Integrate(view);
  int observed = 0;
  for (size_t b = 0; b < volume.blocks().size(); ++b) {
    for (int i = 0; i < kBlockVoxels; ++i) {
      const size_t at = b * kBlockVoxels + static_cast<size_t>(i);
      if (volume.weights()[at] == 0) continue;
      ++observed;
      const double z = kVoxel * (volume.blocks()[b][2] * kBlockSide + (i & 7));
      EXPECT_NEAR(volume.distances()[at], std::min(1.0, (z - kHeight) / kTruncation), 0.05);
      EXPECT_GT(z, kHeight - kTruncation - 1e-3) << "what is hidden is not observed";
    }
  }
  EXPECT_GT(observed, 1000);
}

TEST(TsdfVolume, CarvesWhatAnotherViewSeesThrough) {
  TsdfBlocks blocks(0.05, 0.2);
  const SurfaceView ball = ViewOfShape(SphereAt({0, 0, 1}, 0.3), ShapeCamera({0, 0, 4}, {0, 0, 0}));
  const SurfaceView floor = ViewOfShape(FloorAt(0), ShapeCamera({0, 0.1, 4}, {0, 0, 0}));
  blocks.Add(ball);
  TsdfVolume volume(blocks);
  volume.Integrate(ball);
  const auto inside = [&] {
    return std::count_if(volume.distances().begin(), volume.distances().end(), [](float d) { return d < 0; });
  };
  EXPECT_GT(inside(), 100);
  for (int i = 0; i < 9; ++i) volume.Integrate(floor);
  EXPECT_EQ(inside(), 0);
}

TEST(TsdfBlocks, CountsForLargerVoxels) {
  TsdfBlocks blocks(0.02, 0.08);
  EXPECT_EQ(blocks.count(), 0);
  blocks.Add(ViewOfShape(FloorAt(0), ShapeCamera({0, 0, 2}, {0, 0, 0})));
  EXPECT_EQ(blocks.CountAt(0), blocks.count());
  EXPECT_LT(blocks.CountAt(1), blocks.count() / 2);
  EXPECT_GE(blocks.CountAt(10), 1);
  const auto coordinates = blocks.Coordinates();
  EXPECT_EQ(static_cast<int64_t>(coordinates.size()), blocks.count());
  EXPECT_TRUE(std::is_sorted(coordinates.begin(), coordinates.end()));
}

TEST(RequireRoom, NamesAVoxelThatFits) {
  TsdfBlocks blocks(0.02, 0.08);
  blocks.Add(ViewOfShape(FloorAt(0), ShapeCamera({0, 0, 2}, {0, 0, 0})));
  EXPECT_NO_THROW(RequireRoom(blocks, static_cast<uint64_t>(blocks.count() * kBlockBytes)));
  EXPECT_NO_THROW(RequireRoom(blocks, 0)) << "nobody says how much there is";
  EXPECT_THAT(
      MessageOf<UsageError>([&] { RequireRoom(blocks, static_cast<uint64_t>(blocks.CountAt(2) * kBlockBytes)); }),
      testing::HasSubstr("0.08 fits"));
}

TEST(TsdfBlocks, RefusesVoxelsThatCannotBeCounted) {
  TsdfBlocks blocks(1e-8, 4e-8);
  EXPECT_THAT(MessageOf<UsageError>([&] {
                blocks.Add(ViewOfShape(FloorAt(0), ShapeCamera({0, 0, 2}, {0, 0, 0}, 8)));
              }),
              testing::HasSubstr("--voxel"));
}

}  // namespace
}  // namespace oraclegs
