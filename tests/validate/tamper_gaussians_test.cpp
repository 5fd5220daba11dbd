#include "oraclegs/validate/tamper_gaussians.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "oraclegs/core/error.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

/// A row of Gaussians at x = 0, 1, 2, ... with numbers of their own.
Gaussians Row(int64_t n) {
  const Gaussians g = Gaussians::Empty(n);
  Rng rng(1, RandomStream::kNoise);
  g.ForEach([&](const char*, const Buffer<float>& buffer) {
    for (float& value : buffer.span()) value = static_cast<float>(rng.Uniform(-1, 1));
  });
  for (int64_t i = 0; i < n; ++i) {
    g.means[3 * i] = static_cast<float>(i);
    g.means[3 * i + 1] = g.means[3 * i + 2] = 0;
  }
  return g;
}

/// Whether row j of `a` and row i of `b` have equal bits; means only where they are compared.
bool SameRow(const Gaussians& a, int64_t j, const Gaussians& b, int64_t i, bool means = true) {
  const GaussianRows x = a.Rows().From(j), y = b.Rows().From(i);
  return (!means || std::memcmp(x.means, y.means, 12) == 0) && std::memcmp(x.log_scales, y.log_scales, 12) == 0 &&
         std::memcmp(x.quats, y.quats, 16) == 0 && *x.opacity_logits == *y.opacity_logits &&
         std::memcmp(x.sh, y.sh, 4 * kShFloats) == 0;
}

/// A ball around x = 2 that holds the Gaussians 1, 2 and 3; the other place is around x = 8.
GaussianTampering Ball(GaussianTamperKind kind) {
  GaussianTampering t;
  t.kind = kind, t.center = {2, 0, 0}, t.radius = 1.2f, t.depth = 1, t.source = {8, 0, 0}, t.seed = 4;
  return t;
}

TEST(TamperedGaussians, LeavesWhatIsOutsideAllBalls) {
  const Gaussians honest = Row(12);
  for (int kind = 0; kind < kGaussianTamperKinds; ++kind) {
    const Gaussians g = TamperedGaussians(honest, {Ball(static_cast<GaussianTamperKind>(kind))}).Make(1, 0);
    EXPECT_TRUE(SameRow(g, 0, honest, 0)) << kind;
    int64_t kept = 0;  // all from x = 4 on stand in their order
    while (kept < g.size() && g.means[3 * kept] != 4) ++kept;
    for (int64_t i = 4; i < 12; ++i) EXPECT_TRUE(SameRow(g, kept + i - 4, honest, i)) << kind << " " << i;
  }
}

TEST(TamperedGaussians, MakesTheHonestModelWithoutLies) {
  const Gaussians honest = Row(6);
  const Gaussians g = TamperedGaussians(honest, {Ball(GaussianTamperKind::kDelete)}).Make(0, 0);
  ASSERT_EQ(g.size(), 6);
  for (int64_t i = 0; i < 6; ++i) EXPECT_TRUE(SameRow(g, i, honest, i));
}

TEST(TamperedGaussians, DisplacesTogether) {
  const Gaussians honest = Row(12), g = TamperedGaussians(honest, {Ball(GaussianTamperKind::kDisplace)}).Make(1, 0);
  ASSERT_EQ(g.size(), 12);
  float length = 0;
  for (int d = 0; d < 3; ++d) {
    const float move = g.means[3 + d] - honest.means[3 + d];
    EXPECT_NEAR(g.means[9 + d] - honest.means[9 + d], move, 1e-6f);
    length += move * move;
  }
  EXPECT_GE(std::sqrt(length), 0.029f);
  EXPECT_LE(std::sqrt(length), 0.101f);
  EXPECT_TRUE(SameRow(g, 2, honest, 2, false));
}

TEST(TamperedGaussians, SwapsAndInvents) {
  const Gaussians honest = Row(12);
  const Gaussians swapped = TamperedGaussians(honest, {Ball(GaussianTamperKind::kSwap)}).Make(1, 0);
  ASSERT_EQ(swapped.size(), 12);  // three leave, three come
  const Gaussians more = TamperedGaussians(honest, {Ball(GaussianTamperKind::kInvent)}).Make(1, 0);
  ASSERT_EQ(more.size(), 15);
  for (int64_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(SameRow(swapped, 9 + k, honest, 7 + k, false));
    EXPECT_EQ(swapped.means[3 * (9 + k)], static_cast<float>(1 + k));
    EXPECT_TRUE(SameRow(more, 12 + k, honest, 7 + k, false));
    EXPECT_TRUE(SameRow(more, 1 + k, honest, 1 + k)) << "what is invented replaces nothing";
  }
}

TEST(TamperedGaussians, DeletesAndSmooths) {
  const Gaussians honest = Row(12);
  EXPECT_EQ(TamperedGaussians(honest, {Ball(GaussianTamperKind::kDelete)}).Make(1, 0).size(), 9);
  const Gaussians smooth = TamperedGaussians(honest, {Ball(GaussianTamperKind::kSmooth)}).Make(1, 0);
  ASSERT_EQ(smooth.size(), 10);  // of 1, 2 and 3 the even one stays
  EXPECT_NEAR(smooth.log_scales[3], honest.log_scales[6] + std::log(3.f), 1e-6f);
}

TEST(TamperedGaussians, TonesColorsAlike) {
  Gaussians honest = Row(12);
  for (const int64_t i : {int64_t{1}, int64_t{2}}) honest.sh.Rows(i, i + 1).SetZero();
  const Gaussians g = TamperedGaussians(honest, {Ball(GaussianTamperKind::kTone)}).Make(1, 0);
  for (int c = 0; c < 3; ++c) {
    const float shift = g.sh[kShFloats + c] * 0.28209479177387814f;
    EXPECT_EQ(g.sh[kShFloats + c], g.sh[2 * kShFloats + c]);
    EXPECT_GE(std::abs(shift), 0.0799f);
    EXPECT_LE(std::abs(shift), 0.2501f);
    const float gain = g.sh[3 * kShFloats + 3 + c] / honest.sh[3 * kShFloats + 3 + c];
    EXPECT_GE(gain, 0.699f);
    EXPECT_LE(gain, 1.301f);
  }
}

TEST(TamperedGaussians, FlickersFromViewToView) {
  const TamperedGaussians flicker(Row(12), {Ball(GaussianTamperKind::kFlicker)});
  const TamperedGaussians fixed(Row(12), {Ball(GaussianTamperKind::kDisplace)});
  EXPECT_EQ(flicker.Make(1, 3).means[6], flicker.Make(1, 3).means[6]);
  EXPECT_NE(flicker.Make(1, 3).means[6], flicker.Make(1, 4).means[6]);
  EXPECT_EQ(fixed.Make(1, 3).means[6], fixed.Make(1, 4).means[6]);
}

TEST(TamperedGaussians, FollowTheFirstBall) {
  const TamperedGaussians both(Row(12), {Ball(GaussianTamperKind::kTone), Ball(GaussianTamperKind::kDelete)});
  EXPECT_EQ(both.Make(2, 0).size(), 12);
}

TEST(TamperedGaussians, RefusesBuffersThatDoNotFit) {
  Gaussians broken = Row(3);
  broken.quats = Buffer<float>::Zeros({2, 4});
  EXPECT_THROW(TamperedGaussians(broken, {}), ShapeError);
}

/// A wall at a depth of 2, half of which is not known.
std::vector<Proposal> HalfAWall() {
  Camera camera;
  camera.width = 40, camera.height = 30, camera.fx = camera.fy = 40, camera.cx = 20, camera.cy = 15;
  camera.cam_from_world.translation() = Eigen::Vector3d(0, 0, 1);  // the camera stands at z = -1
  Proposal proposal{"p", "proxies", camera, {}};
  for (int i = 0; i < 40 * 30; ++i) proposal.inv_depth.push_back(i % 40 < 20 ? 0.5f : 0.f);
  return {proposal};
}

TEST(DrawGaussianTamperings, PutsBallsOnSurfaces) {
  const std::vector<GaussianTampering> lies = DrawGaussianTamperings(HalfAWall(), 200, 7);
  ASSERT_EQ(lies.size(), 201u);
  std::set<GaussianTamperKind> kinds;
  for (size_t k = 0; k < 200; ++k) {
    const GaussianTampering& t = lies[k];
    kinds.insert(t.kind);
    EXPECT_FLOAT_EQ(t.depth, 2);
    EXPECT_FLOAT_EQ(t.source.z(), 1);
    EXPECT_LE(t.center.x(), 0);
    // 30 of 40 pixels at a depth of 2 are 1.5.
    EXPECT_GE(t.radius, 0.0599f);
    EXPECT_LE(t.radius, 0.3001f);
    if (t.kind == GaussianTamperKind::kInvent) {
      EXPECT_LE(t.center.z(), 0.7001f);
      EXPECT_GE(t.center.z(), 0.1999f);
    } else {
      EXPECT_FLOAT_EQ(t.center.z(), 1);
    }
  }
  EXPECT_EQ(kinds.size(), static_cast<size_t>(kGaussianTamperKinds));
  EXPECT_TRUE(std::isinf(lies.back().radius));
}

TEST(DrawGaussianTamperings, IsAFunctionOfTheSeedAndBeginsAlike) {
  const auto few = DrawGaussianTamperings(HalfAWall(), 5, 7), many = DrawGaussianTamperings(HalfAWall(), 9, 7);
  for (size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(few[k].center, many[k].center);
    EXPECT_EQ(few[k].kind, many[k].kind);
  }
  EXPECT_NE(few[0].center, DrawGaussianTamperings(HalfAWall(), 5, 8)[0].center);
}

TEST(DrawGaussianTamperings, TonesEverythingWithoutDepth) {
  std::vector<Proposal> blind = HalfAWall();
  std::fill(blind[0].inv_depth.begin(), blind[0].inv_depth.end(), 0.f);
  const std::vector<GaussianTampering> lies = DrawGaussianTamperings(blind, 5, 7);
  ASSERT_EQ(lies.size(), 1u);
  const Gaussians honest = Row(4), g = TamperedGaussians(honest, lies).Make(1, 0);
  for (int64_t i = 0; i < 4; ++i) EXPECT_FALSE(SameRow(g, i, honest, i));
}

}  // namespace
}  // namespace oraclegs
