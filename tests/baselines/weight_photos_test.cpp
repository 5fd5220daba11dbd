#include "oraclegs/baselines/weight_photos.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/loss/photometric.h"
#include "oraclegs/train/trainer.h"
#include "support/errors.h"
#include "support/temp_dir.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

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
  EXPECT_NEAR(MeanConfidence(weighted[0].pixel_weight), 0.75, 1e-6);
  EXPECT_NEAR(MeanConfidence(weighted[1].pixel_weight), 0.75, 1e-6);
  EXPECT_NEAR(MeanConfidence(weighted[2].pixel_weight), 1.5, 1e-6);
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
