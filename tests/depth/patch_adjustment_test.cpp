#include "oraclegs/depth/patch_adjustment.h"

#include <gtest/gtest.h>

#include "depth/disturbed.h"
#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr size_t kPointsOfView = 1000;
constexpr int kRounds = 3;

class PatchAdjustmentTest : public testing::Test {
 protected:
  ~PatchAdjustmentTest() override { SetNumThreads(threads_); }

  /// Points of random depth in each view, about 1 % wrong.
  void Make(const std::vector<Camera>& true_cameras, const std::vector<Camera>& given_cameras) {
    truth = true_cameras;
    scene.cameras = given = given_cameras;
    Rng rng(5, RandomStream::kTargets);
    for (size_t v = 0; v < truth.size(); ++v) {
      for (size_t k = 0; k < kPointsOfView; ++k) {
        const auto u = static_cast<float>(rng.Uniform(0, truth[v].width));
        true_depths.push_back(rng.Uniform(0.18, 0.35));
        scene.pixels.push_back({static_cast<int>(v), u, static_cast<float>(rng.Uniform(0, truth[v].height)),
                                true_depths.back() * (1 + rng.Uniform(-0.01, 0.01)), 0, 0});
      }
    }
  }

  /// Offsets of all points in all other views, which the true cameras give.
  std::vector<PatchOffset> Offsets() const {
    std::vector<PatchOffset> offsets;
    for (size_t p = 0; p < scene.pixels.size(); ++p) {
      const OffsetPixel& pixel = scene.pixels[p];
      const auto v = static_cast<size_t>(pixel.view);
      for (size_t other = 0; other < truth.size(); ++other) {
        if (other == v) continue;
        const auto seen = Reproject(truth[v], truth[other], {pixel.u, pixel.v, true_depths[p]});
        const auto expected = Reproject(scene.cameras[v], scene.cameras[other], {pixel.u, pixel.v, pixel.inv_depth});
        const Eigen::Vector2d offset = seen->at - expected->at, along = expected->by_inv_depth.normalized();
        offsets.push_back({static_cast<int>(p), static_cast<int>(other), expected->at, offset,
                           along.x() * offset.y() - along.y() * offset.x()});
      }
    }
    return offsets;
  }

  void Adjust() {
    for (int round = 0; round < kRounds; ++round) AdjustScene(Offsets(), given, &scene);
  }

  std::vector<Camera> truth, given;
  std::vector<double> true_depths;
  AdjustedScene scene;

 private:
  int threads_ = NumThreads();
};

TEST_F(PatchAdjustmentTest, FindsPosesAndDepths) {
  Make(Arc(5, 10, 480, 360), Disturbed(Arc(5, 10, 480, 360), 0.3, 0.01, 1));
  const CameraMovement before = MeanMovement(truth, given);
  Adjust();
  const CameraMovement after = MeanMovement(truth, scene.cameras);
  EXPECT_GT(before.degrees, 0.15);
  EXPECT_LT(after.degrees, 0.05 * before.degrees);
  EXPECT_LT(after.share, 0.05 * before.share);
  const double scale = SimilarityBetween(truth, scene.cameras).scale;
  for (size_t p = 0; p < scene.pixels.size(); ++p) {
    EXPECT_NEAR(scene.pixels[p].inv_depth * scale / true_depths[p], 1, 0.002);
  }
}

TEST_F(PatchAdjustmentTest, HoldsTheFirstCameraAndTheLongestBaseline) {
  Make(Arc(5, 10, 480, 360), Disturbed(Arc(5, 10, 480, 360), 0.3, 0.01, 2));
  Adjust();
  EXPECT_EQ(scene.cameras[0].cam_from_world.matrix(), given[0].cam_from_world.matrix());
  EXPECT_NEAR((scene.cameras[0].Center() - scene.cameras[4].Center()).norm(),
              (given[0].Center() - given[4].Center()).norm(), 1e-9);
  EXPECT_NE(scene.cameras[2].cam_from_world.matrix(), given[2].cam_from_world.matrix());
}

TEST_F(PatchAdjustmentTest, IsRobustToWrongOffsets) {
  Make(Arc(5, 10, 480, 360), Disturbed(Arc(5, 10, 480, 360), 0.3, 0.01, 3));
  for (int round = 0; round < kRounds; ++round) {
    std::vector<PatchOffset> offsets = Offsets();
    for (size_t k = 0; k < offsets.size(); k += 10) offsets[k].offset += Eigen::Vector2d(9, -6);
    AdjustScene(offsets, given, &scene);
  }
  EXPECT_LT(MeanMovement(truth, scene.cameras).degrees, 0.2 * MeanMovement(truth, given).degrees);
}

TEST_F(PatchAdjustmentTest, LeavesViewsWithoutOffsets) {
  Make(Arc(5, 10, 480, 360), Disturbed(Arc(5, 10, 480, 360), 0.3, 0.01, 4));
  std::vector<PatchOffset> offsets = Offsets();
  std::erase_if(offsets, [&](const PatchOffset& offset) {
    return offset.source == 3 || scene.pixels[static_cast<size_t>(offset.pixel)].view == 3;
  });
  AdjustScene(offsets, given, &scene);
  EXPECT_LT(TwistBetween(given[3], scene.cameras[3]).tail<3>().norm(), 1e-9);
}

TEST_F(PatchAdjustmentTest, KeepsWhatCannotBeAdjusted) {
  const Camera camera = Arc(1, 10, 480, 360).front();
  for (const size_t n : {size_t{0}, size_t{1}, size_t{2}}) {
    const std::vector<Camera> same(n, camera);
    AdjustedScene still{same, {}};
    AdjustScene({}, same, &still);
    for (const Camera& kept : still.cameras) {
      EXPECT_EQ(kept.cam_from_world.matrix(), camera.cam_from_world.matrix());
    }
  }
}

TEST_F(PatchAdjustmentTest, FindsTheRelativePoseOfTwoViews) {
  Make(Arc(2, 20, 480, 360), Disturbed(Arc(2, 20, 480, 360), 0.3, 0.01, 6));
  Adjust();
  EXPECT_LT(MeanMovement(truth, scene.cameras).degrees, 0.3 * MeanMovement(truth, given).degrees);
}

TEST_F(PatchAdjustmentTest, HasTheSameBitsForAnyNumberOfThreads) {
  Make(Arc(4, 10, 480, 360), Disturbed(Arc(4, 10, 480, 360), 0.3, 0.01, 7));
  AdjustedScene results[2];
  for (const int threads : {1, 3}) {
    SetNumThreads(threads);
    results[threads / 2] = scene;
    AdjustScene(Offsets(), given, &results[threads / 2]);
  }
  for (size_t v = 0; v < given.size(); ++v) {
    EXPECT_EQ(results[0].cameras[v].cam_from_world.matrix(), results[1].cameras[v].cam_from_world.matrix());
  }
  for (size_t p = 0; p < scene.pixels.size(); ++p) {
    EXPECT_EQ(results[0].pixels[p].inv_depth, results[1].pixels[p].inv_depth);
  }
}

}  // namespace
}  // namespace oraclegs
