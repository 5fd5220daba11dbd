#include "oraclegs/train/outliers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/train/mcmc.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

/// Looks along z from (x, 0, 0) at a wall at z = 4.
TrainView WallView(double x) {
  TrainView view{"a", {20, 16, 20, 20, 10, 8, Eigen::Isometry3d::Identity()}, Buffer<float>::Zeros({16, 20, 3}), {}};
  view.camera.cam_from_world.translation() = Eigen::Vector3d(-x, 0, 0);
  view.inv_depth = Buffer<float>::Full({16, 20}, 0.25f);
  view.depth_mask = Buffer<float>::Full({16, 20}, 1.f);
  return view;
}

/// Opaque Gaussians at these places.
Gaussians At(const std::vector<std::array<float, 3>>& places) {
  Gaussians g = RandomGaussians(static_cast<int64_t>(places.size()), 1);
  std::copy(&places[0][0], &places[0][0] + 3 * places.size(), g.means.data());
  Flat(g.opacity_logits).setConstant(2);
  return g;
}

std::vector<int> Dead(const Gaussians& g) {
  std::vector<int> dead;
  for (int64_t i = 0; i < g.size(); ++i) dead.push_back(std::abs(g.opacity_logits[i] - 2) > 0);
  return dead;
}

TEST(PruneFloatersTest, WhatHangsBeforeTheWallDies) {
  const std::vector<TrainView> views = {WallView(0), WallView(0.2)};
  Gaussians g = At({{0, 0, 4}, {0, 0, 3}, {0, 0, 3.8f}, {0, 0, 3.5f}, {0, 0, 6}, {0, 0, -3}, {9, 0, 3}});
  EXPECT_EQ(PruneFloaters(views, &g), 2);
  // On the wall, before, a little before (neither), before, behind, behind the camera, beside the image.
  EXPECT_EQ(Dead(g), (std::vector<int>{0, 1, 0, 1, 0, 0, 0}));
  EXPECT_LE(1 / (1 + std::exp(-g.opacity_logits[1])), kDeadOpacity);
  EXPECT_EQ(PruneFloaters(views, &g), 0);  // the dead do not die again
}

TEST(PruneFloatersTest, ViewsWithoutTrustedDepthHaveNoSay) {
  TrainView mute = WallView(0), doubtful = WallView(0);
  mute.inv_depth = mute.depth_mask = Buffer<float>();
  Flat(doubtful.depth_mask).setConstant(0.5f);
  Gaussians g = At({{0, 0, 4}, {0, 0, 3}});
  EXPECT_EQ(PruneFloaters({mute, doubtful}, &g), 0);
  EXPECT_EQ(PruneFloaters({mute, doubtful, WallView(0)}, &g), 1);
}

TEST(PruneFloatersTest, AgreementOfMoreViewsSaves) {
  TrainView agrees = WallView(0);  // sees a wall at z = 3, where the Gaussian is
  Flat(agrees.inv_depth).setConstant(1 / 3.f);
  const auto dead = [&](const std::vector<TrainView>& views) {
    Gaussians g = At({{0, 0, 3}, {0, 0, 20}});
    return PruneFloaters(views, &g);
  };
  EXPECT_EQ(dead({WallView(0), agrees}), 1);
  EXPECT_EQ(dead({WallView(0), agrees, agrees}), 0);
  EXPECT_EQ(dead({agrees}), 0);
}

TEST(PruneFloatersTest, TheLastOnesAreSpared) {
  Gaussians g = At({{0, 0, 3}, {0, 0, 2}});
  EXPECT_EQ(PruneFloaters({WallView(0)}, &g), 0);
  EXPECT_EQ(Dead(g), (std::vector<int>{0, 0}));
}

TEST(PruneFloatersTest, SameForAnyNumberOfThreads) {
  const std::vector<TrainView> views = {WallView(0), WallView(0.5), WallView(1)};
  Gaussians start = RandomGaussians(5000, 4);
  Table(start.means).col(2) += 3.5f;
  const auto run = [&](int threads) {
    const Threads scope(threads);
    Gaussians g = start.Clone();
    EXPECT_GT(PruneFloaters(views, &g), 500);
    return g;
  };
  EXPECT_TRUE(SameBits(run(1), run(4)));
}

TEST(TrainerFloatersTest, PruningMovesThemToTheSurface) {
  auto views = Photos(4);
  for (TrainView& view : views) {  // everything is as far away as the origin: before it is the air
    view.inv_depth = Buffer<float>::Full({kHeight, kWidth}, 1 / 3.f);
    view.depth_mask = Buffer<float>::Full({kHeight, kWidth}, 1.f);
  }
  const auto before = [&](bool prune) {
    TrainOptions options = Options(100);
    options.depth_weight = 0;
    options.prune_floaters = prune;
    Trainer trainer(options, kSeed, {0, 0, 0}, views, Start());
    for (int i = 0; i < 40; ++i) trainer.Step();  // the 40th relocates
    Gaussians g = trainer.gaussians().Clone();
    return PruneFloaters(views, &g);
  };
  EXPECT_GT(before(false), 0);
  EXPECT_LT(before(true), before(false) / 2);
}

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
