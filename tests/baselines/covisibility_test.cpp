#include "oraclegs/baselines/covisibility.h"
#include "oraclegs/loss/photometric.h"
#include "oraclegs/train/trainer.h"
#include "support/errors.h"
#include "support/temp_dir.h"
#include "train/small_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/buffers.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

/// Looks along z from (x, 0, 0) at a wall at z = 4; a pixel is 0.2 wide there, the image 4 x 3.2.
CovisibilityView WallFrom(double x) {
  CovisibilityView view{
      {20, 16, 20, 20, 10, 8, Eigen::Isometry3d::Identity()}, Buffer<float>::Full({16, 20}, 0.25f), {}};
  view.camera.cam_from_world.translation() = Eigen::Vector3d(-x, 0, 0);
  return view;
}

/// Values of a row's pixels.
std::vector<float> RowOf(const Buffer<float>& map, int64_t row) {
  const auto numbers = map.Rows(row, row + 1).span();
  return {numbers.begin(), numbers.end()};
}

std::vector<float> Steps(std::initializer_list<std::pair<int, float>> runs) {
  std::vector<float> out;
  for (const auto& [count, value] : runs) out.insert(out.end(), count, value);
  return out;
}

TEST(CovisibilityMap, CountsTheViewsThatSeeTheWall) {
  // 5 and 10 pixels to the right, and one that sees nothing of it.
  const std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1), WallFrom(2), WallFrom(9)};
  for (int64_t row = 0; row < 16; ++row) {
    EXPECT_EQ(RowOf(CovisibilityMap(views, 0), row), Steps({{5, 0}, {5, 1}, {10, 2}}));
    EXPECT_EQ(RowOf(CovisibilityMap(views, 1), row), Steps({{5, 1}, {10, 2}, {5, 1}}));
    EXPECT_EQ(RowOf(CovisibilityMap(views, 3), row), Steps({{20, 0}}));
  }
}

TEST(CovisibilityMap, NeedsDepthsThatAgree) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1)};
  views[1].inv_depth[3 * 20 + 7] = 0.25f / 1.04f;  // within 5%: still the wall
  views[1].inv_depth[3 * 20 + 8] = 0.25f / 0.9f;   // something before it
  views[1].inv_depth[3 * 20 + 9] = 0;              // nothing
  EXPECT_EQ(RowOf(CovisibilityMap(views, 0), 3), Steps({{5, 0}, {8, 1}, {2, 0}, {5, 1}}));
  EXPECT_EQ(RowOf(CovisibilityMap(views, 0, 0.01), 3), Steps({{5, 0}, {7, 1}, {3, 0}, {5, 1}}));
}

TEST(CovisibilityMap, IgnoresUnknownDepth) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1), WallFrom(0)};
  views[0].mask = Buffer<float>::Full({16, 20}, 1.f);
  views[0].mask[2 * 20 + 6] = 0.5f;
  views[1].mask = Buffer<float>::Full({16, 20}, 1.f);
  views[1].mask[2 * 20 + 2] = 0;
  views[2].inv_depth = {};
  EXPECT_EQ(RowOf(CovisibilityMap(views, 0), 2), Steps({{5, 0}, {1, 1}, {2, 0}, {12, 1}}));
  EXPECT_EQ(MaxAbs(CovisibilityMap(views, 2)), 0);
}

TEST(CovisibilityMap, IgnoresWhatLiesBehindTheOther) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(0)};
  views[1].camera.cam_from_world.linear() = Eigen::AngleAxisd(3.14159265, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_EQ(MaxAbs(CovisibilityMap(views, 0)), 0);
}

TEST(CovisibilityWeights, AreLargestWhereOneViewIsAlone) {
  const Buffer<float> map = Buffer<float>::From({1, 3}, {0, 1, 3});
  EXPECT_TRUE(Equal(CovisibilityWeights(map), Buffer<float>::From({1, 3}, {1, 0.5f, 0.25f})));
}

TEST(CovisibilityMap, SameForAnyNumberOfThreads) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1), WallFrom(0.3)};
  views[2].inv_depth = RandomUniform({16, 20}, 1);
  const auto run = [&](int threads) {
    const Threads scope(threads);
    return CovisibilityMap(views, 0);
  };
  EXPECT_TRUE(SameBytes(run(1), run(3)));
}

TEST(CovisibilityMap, RefusesWhatDoesNotFit) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1)};
  EXPECT_THROW(CovisibilityMap(views, 2), ShapeError);
  views[1].mask = Buffer<float>::Zeros({20, 16});
  EXPECT_THROW(CovisibilityMap(views, 0), ShapeError);
  EXPECT_THROW(CovisibilityWeights(Buffer<float>::Zeros({4})), ShapeError);
}

constexpr int64_t kColumns = 20, kRows = 16;

/// Looks along z from (x, 0, 0) at a wall at z = 4; a pixel is 0.2 wide there.
TrainView PhotoOfWall(double x) {
  TrainView photo{"wall", {kColumns, kRows, 20, 20, 10, 8, Eigen::Isometry3d::Identity()}, {}, {}};
  photo.camera.cam_from_world.translation().x() = -x;
  photo.image = Buffer<float>::Full({kRows, kColumns, 3}, 0.5f);
  photo.inv_depth = Buffer<float>::Full({kRows, kColumns}, 0.25f);
  photo.depth_mask = Buffer<float>::Full({kRows, kColumns}, 1.f);
  return photo;
}

TEST(WeightByCovisibility, CountsMoreWhatOnePhotoAloneShows) {
  // Each sees 5 of 20 columns alone: weights 1 and 1/2, of mean 5/8.
  const std::vector<TrainView> weighted = WeightByCovisibility({PhotoOfWall(0), PhotoOfWall(1)});
  for (int64_t row = 0; row < kRows; ++row) {
    for (int64_t column = 0; column < kColumns; ++column) {
      const int64_t i = row * kColumns + column;
      EXPECT_FLOAT_EQ(weighted[0].pixel_weight[i], column < 5 ? 1.6f : 0.8f);
      EXPECT_FLOAT_EQ(weighted[1].pixel_weight[i], column < 15 ? 0.8f : 1.6f);
    }
  }
}

TEST(WeightByCovisibility, HasMeanOneOverAllPhotosTogether) {
  // Two see the same, one sees what no other does: it counts more as a whole.
  const std::vector<TrainView> weighted = WeightByCovisibility({PhotoOfWall(0), PhotoOfWall(0), PhotoOfWall(50)});
  EXPECT_NEAR(MeanConfidence(weighted[0]), 0.75, 1e-6);
  EXPECT_NEAR(MeanConfidence(weighted[1]), 0.75, 1e-6);
  EXPECT_NEAR(MeanConfidence(weighted[2]), 1.5, 1e-6);
}

TEST(WeightByCovisibility, KeepsMasksAndWhatIsKnownToBeEmpty) {
  std::vector<TrainView> photos = {PhotoOfWall(0), PhotoOfWall(1)};
  photos[0].pixel_weight = Buffer<float>::Full({kRows, kColumns}, 1.f);
  const int64_t masked = 12, empty = 13, unknown = 14;
  photos[0].pixel_weight[masked] = 0;
  photos[0].inv_depth[empty] = 0;
  photos[0].depth_mask[unknown] = 0.5f;
  const std::vector<TrainView> weighted = WeightByCovisibility(photos);
  const Buffer<float>& w = weighted[0].pixel_weight;
  EXPECT_EQ(w[masked], 0);
  EXPECT_EQ(w[empty], 1);
  EXPECT_EQ(w[unknown], w[0]) << "as what one photo alone shows";
  EXPECT_FLOAT_EQ(w[0], 2 * w[15]);
  EXPECT_EQ(photos[0].pixel_weight[0], 1) << "what was given is not written";
  EXPECT_FALSE(photos[1].pixel_weight.defined());
}

TEST(WeightByCovisibility, WeighsBothPartsOfTheLoss) {
  const Buffer<float> weights = WeightByCovisibility({PhotoOfWall(0), PhotoOfWall(1)})[0].pixel_weight;
  const Buffer<float> target = Buffer<float>::Full({kRows, kColumns, 3}, 0.5f);
  const auto loss = [&](int64_t column, const Buffer<float>& mask) {
    Buffer<float> render = target.Clone();
    render[3 * (8 * kColumns + column)] += 0.25f;
    PhotometricLoss photometric;
    return photometric(render, target, {mask, MaskMeaning::kMask}, {}, nullptr);
  };
  // L1 at the pixel itself; SSIM in the 11 x 11 windows that see it, here all of one weight.
  const double l1 = 0.25 / static_cast<double>(3 * kRows * kColumns);
  EXPECT_NEAR(loss(2, weights).l1, 1.6 * l1, 1e-8);
  EXPECT_NEAR(loss(12, weights).l1, 0.8 * l1, 1e-8);
  EXPECT_GT(loss(12, {}).dssim, 1e-3);
  EXPECT_NEAR(loss(12, weights).dssim, 0.8 * loss(12, {}).dssim, 1e-6);
}

/// Photos of the small scene with its depth.
std::vector<TrainView> UnweightedPhotos() {
  std::vector<TrainView> photos = Photos(3);
  auto rasterizer = MakeRasterizer(kCpu);
  for (TrainView& photo : photos) {
    const RenderOutput out = rasterizer->Forward(Truth(), photo.camera, {}, RenderPass::kInference);
    photo.inv_depth = out.inv_depth.Clone();
    photo.depth_mask = Above(out.alpha, 0.5f);
  }
  return photos;
}

std::vector<TrainView> WeightedPhotos() { return WeightByCovisibility(UnweightedPhotos()); }

TEST(WeightByCovisibility, TrainsTheSameBitsForAnyNumberOfThreadsAndResumed) {
  TempDir dir;
  Trainer whole(Options(), kSeed, {0, 0, 0}, WeightedPhotos(), Start());
  whole.Run({dir.path(), 45, {}}, Silent());
  Trainer plain(Options(), kSeed, {0, 0, 0}, UnweightedPhotos(), Start());
  plain.Run({}, Silent());
  EXPECT_FALSE(SameBits(plain.gaussians(), whole.gaussians()));
  const Threads scope(3);
  Trainer threads(Options(), kSeed, {0, 0, 0}, WeightedPhotos(), Start());
  threads.Run({}, Silent());
  EXPECT_TRUE(SameBits(threads.gaussians(), whole.gaussians()));
  Trainer resumed(Options(), kSeed, {0, 0, 0}, WeightedPhotos(), Start());
  resumed.Restore(ReadCheckpoint(CheckpointPath(dir.path(), 45)));
  resumed.Run({}, Silent());
  EXPECT_TRUE(SameBits(resumed.gaussians(), whole.gaussians()));
}

TEST(WeightByCovisibility, NeedsDepth) {
  EXPECT_THAT(MessageOf<UsageError>([] { WeightByCovisibility(Photos(2)); }),
              testing::HasSubstr("weights by covisibility need the depth of the photos"));
}

}  // namespace

}  // namespace oraclegs
