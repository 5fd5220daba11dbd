#include "oraclegs/train/scale_cap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "train/small_scene.h"

namespace oraclegs {
namespace {

/// Gaussians of one scale on the x axis.
Gaussians OnAxis(const std::vector<float>& places, float scale) {
  Gaussians g = RandomGaussians(static_cast<int64_t>(places.size()), 1);
  g.means.SetZero();
  for (size_t i = 0; i < places.size(); ++i) g.means[static_cast<int64_t>(3 * i)] = places[i];
  Flat(g.log_scales).setConstant(std::log(scale));
  return g;
}

double Scale(const Gaussians& g, int64_t i, int64_t axis = 0) {
  return std::exp(static_cast<double>(g.log_scales[3 * i + axis]));
}

TEST(CapScalesTest, OfTheDistanceToTheNearestCamera) {
  Gaussians g = OnAxis({0, 4, 9, 100}, 3);
  CapScales({1, 0, 0, 10, 0, 0}, 0.5, &g);
  EXPECT_NEAR(Scale(g, 0), 0.5, 1e-6);
  EXPECT_NEAR(Scale(g, 1), 1.5, 1e-6);
  EXPECT_NEAR(Scale(g, 2), 0.5, 1e-6);
  EXPECT_NEAR(Scale(g, 3), 3, 1e-6);
}

TEST(CapScalesTest, EachAxisAloneAndNothingElse) {
  Gaussians g = OnAxis({2}, 0.1f);
  g.log_scales[1] = std::log(50.f);
  const Gaussians before = g.Clone();
  CapScales({0, 0, 0}, 0.7, &g);
  EXPECT_NEAR(Scale(g, 0, 1), 1.4, 1e-6);
  EXPECT_EQ(Scale(g, 0, 0), Scale(before, 0, 0));
  EXPECT_EQ(Scale(g, 0, 2), Scale(before, 0, 2));
  EXPECT_TRUE(Equal(g.means, before.means));
  EXPECT_TRUE(Equal(g.opacity_logits, before.opacity_logits));
}

TEST(CapScalesTest, InACameraSomeSizeIsLeftAndWithoutCamerasAll) {
  Gaussians g = OnAxis({0}, 3);
  CapScales({}, 0.7, &g);
  EXPECT_NEAR(Scale(g, 0), 3, 1e-6);
  CapScales({0, 0, 0}, 0.7, &g);
  EXPECT_GT(Scale(g, 0), 1e-8);
  EXPECT_LT(Scale(g, 0), 1e-5);
}

TEST(CapScalesTest, CentersAreTheCamerasInTheWorld) {
  const std::vector<TrainView> views = Photos(2);
  const std::vector<float> centers = CameraCenters(views);
  ASSERT_EQ(centers.size(), 6u);
  for (int v = 0; v < 2; ++v) {
    const Eigen::Vector3d center = views[static_cast<size_t>(v)].camera.Center();
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(centers[static_cast<size_t>(3 * v + k)], center[k], 1e-6);
  }
}

TEST(CapScalesTest, ATrainingKeepsThemToTheEnd) {
  const auto largest = [](double share) {
    TrainOptions options = Options();
    options.largest_scale = share;
    const std::vector<TrainView> photos = Photos(3);
    const std::vector<float> centers = CameraCenters(photos);
    Trainer trainer(options, kSeed, {0, 0, 0}, photos, Start());
    for (int i = 0; i < options.iterations; ++i) trainer.Step();
    const Gaussians& g = trainer.gaussians();
    double most = 0;
    for (int64_t i = 0; i < g.size(); ++i) {
      double nearest = 1e30;
      for (size_t c = 0; c < centers.size(); c += 3) {
        const Eigen::Vector3f center(centers[c], centers[c + 1], centers[c + 2]);
        const Eigen::Map<const Eigen::Vector3f> mean(g.means.data() + 3 * i);
        nearest = std::min(nearest, static_cast<double>((mean - center).norm()));
      }
      for (int64_t k = 0; k < 3; ++k) most = std::max(most, Scale(g, i, k) / nearest);
    }
    return most;
  };
  EXPECT_GT(largest(0), 0.05);
  EXPECT_LT(largest(0.02), 0.0201);
}

}  // namespace
}  // namespace oraclegs
