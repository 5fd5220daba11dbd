#include "oraclegs/train/floaters.h"

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

}  // namespace
}  // namespace oraclegs
