#include "oraclegs/propose/warp.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

double MeanError(const ImageF& a, const ImageF& b) {
  double sum = 0;
  for (size_t i = 0; i < a.data.size(); ++i) sum += std::abs(a.data[i] - b.data[i]);
  return sum / static_cast<double>(a.data.size());
}

/// A far wall with a near square before it, whose depths are known.
class WarpTest : public testing::Test {
 protected:
  WarpTest() {
    near.half_side = 0.5;
    near.point = {0, 0, -1.5};
    far.point = {0, 0, 1.5};
    for (const Camera& camera : Arc(5, 8)) {
      views.push_back(Take(camera));
      maps.push_back(DepthOf(camera));
    }
  }

  LoadedView Take(const Camera& camera) const {
    LoadedView front = near.Take(camera, fmt::format("p{}", views.size())), back = far.Take(camera, front.name);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        if (near.DepthAt(camera, x + 0.5, y + 0.5) > 0) continue;
        std::copy_n(back.rgb.row(y) + 3 * x, 3, front.rgb.row(y) + 3 * x);
      }
    }
    return front;
  }

  DepthMap DepthOf(const Camera& camera) const {
    DepthMap map = TrueDepth(far.Take(camera, "m"), far, 0.9f);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const double depth = near.DepthAt(camera, x + 0.5, y + 0.5);
        if (depth > 0) map.inv_depth[static_cast<size_t>(y * camera.width + x)] = static_cast<float>(1 / depth);
      }
    }
    return map;
  }

  TexturedPlane near, far;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
};

TEST_F(WarpTest, MatchesTruthInNewView) {
  const Camera between = CameraAt({0.3, 0, -4}, {0, 0, 0}, 96, 72);
  const WarpedView view = Warper({views, maps}).Warp(between);
  EXPECT_LT(MeanError(view.rgb, Take(between).rgb), 0.03);
  const DepthMap truth = DepthOf(between);
  size_t right = 0;
  for (size_t i = 0; i < truth.size(); ++i)
    right += std::abs(view.inv_depth[i] / truth.inv_depth[i] - 1) < 0.02 ? 1 : 0;
  EXPECT_GT(right, truth.size() * 95 / 100);
}

TEST_F(WarpTest, SurfacesAreTheDepthsThatAreNotFilled) {
  const Camera aside = CameraAt({2.6, 0, -3}, {0, 0, 0}, 96, 72);
  const Warper warper({views, maps});
  const WarpedView view = warper.Warp(aside);
  const WarpDepth surfaces = warper.Surfaces(aside);
  size_t filled = 0;
  for (size_t i = 0; i < view.inv_depth.size(); ++i) {
    EXPECT_EQ(surfaces.inv_depth[i], view.evidence[i].ring == 0 ? view.inv_depth[i] : 0);
    filled += view.evidence[i].ring > 0 ? 1 : 0;
  }
  EXPECT_GT(filled, 0u);
  EXPECT_LT(filled, view.inv_depth.size());
}

TEST_F(WarpTest, SupportIsHigherForSeenThanFilled) {
  const Camera aside = CameraAt({2.6, 0, -3}, {0, 0, 0}, 96, 72);
  const WarpedView view = Warper({views, maps}).Warp(aside);
  double known = 0, filled = 0;
  size_t number_known = 0, number_filled = 0;
  for (const PixelEvidence& e : view.evidence) {
    (e.ring > 0 ? filled : known) += e.support;
    (e.ring > 0 ? number_filled : number_known) += 1;
  }
  ASSERT_GT(number_filled, 50u);
  ASSERT_GT(number_known, 50u);
  EXPECT_GT(known / static_cast<double>(number_known), 1.5 * filled / static_cast<double>(number_filled));
}

TEST_F(WarpTest, HoldsViewOut) {
  views[2].rgb.data.assign(views[2].rgb.data.size(), 0.f);  // black: none of it may show
  const WarpedView view = Warper({views, maps}).Warp(views[2].camera, 2);
  EXPECT_LT(MeanError(view.rgb, Take(views[2].camera).rgb), 0.05);
  for (const uint16_t from : view.provenance) EXPECT_NE(from, 3);
}

TEST_F(WarpTest, IsLessSureWithoutAView) {
  const Warper warper({views, maps});
  const WarpedView with = warper.Warp(views[1].camera), without = warper.Warp(views[1].camera, 2);
  double fallen = 0;
  for (size_t i = 0; i < with.evidence.size(); ++i)
    fallen += with.evidence[i].confidence - without.evidence[i].confidence;
  EXPECT_GT(fallen / static_cast<double>(with.evidence.size()), 0.02) << "it agreed with the others";
}

TEST_F(WarpTest, DividesColorsByGains) {
  const Camera between = CameraAt({0.3, 0, -4}, {0, 0, 0}, 96, 72);
  const ImageF truth = Take(between).rgb;
  for (float& value : views[2].rgb.data) value *= 0.5f;
  for (float& value : views[3].rgb.data) value *= 0.5f;
  WarpSources sources{views, maps};
  sources.gains.assign(5, Eigen::Vector3f::Ones());
  sources.gains[2].setConstant(0.5f), sources.gains[3].setConstant(0.5f);
  EXPECT_LT(MeanError(Warper(sources).Warp(between).rgb, truth), 0.03);
}

TEST_F(WarpTest, RecordsProvenance) {
  const WarpedView view = Warper({views, maps}).Warp(views[1].camera);
  size_t own = 0;
  for (const uint16_t from : view.provenance) own += from == 2 ? 1 : 0;
  EXPECT_GT(own, view.provenance.size() * 9 / 10);
}

TEST_F(WarpTest, ShowsBackgroundWithoutDepth) {
  const Camera away = CameraAt({0, 0, -4}, {0, 0, -9}, 24, 16);
  WarpSources sources{views, maps};
  sources.background = {0.25f, 0.5f, 0.75f};
  const WarpedView view = Warper(sources).Warp(away);
  for (size_t i = 0; i < view.inv_depth.size(); ++i) {
    EXPECT_EQ(view.inv_depth[i], 0.f);
    EXPECT_EQ(view.evidence[i].ring, 40.f);
    EXPECT_EQ(view.rgb.data[3 * i + 2], 0.75f);
  }
}

TEST(Warper, ShowsBackgroundBesideObject) {
  TexturedPlane square;
  square.half_side = 0.7;
  const std::vector<Camera> cameras = Arc(5, 14);
  const std::vector<LoadedView> views = TakeAll(square, cameras);
  std::vector<DepthMap> maps;
  for (const LoadedView& view : views) maps.push_back(TrueDepth(view, square, 0.9f));
  const Silhouettes silhouettes(views);
  ASSERT_FALSE(silhouettes.empty());
  const Camera between = CameraAt({0.4, 0, -4}, {0, 0, 0}, 96, 72);
  const WarpedView view = Warper({views, maps, {}, &silhouettes, {1, 1, 1}}).Warp(between);
  const LoadedView truth = square.Take(between, "truth");
  EXPECT_EQ(view.evidence[0].background, 1.f);
  EXPECT_EQ(view.evidence[72 / 2 * 96 + 96 / 2].background, 0.f);
  EXPECT_LT(MeanError(view.rgb, truth.rgb), 0.02);
}

TEST_F(WarpTest, ProposesWarpedView) {
  const Warper warper({views, maps});
  const auto proposal = WarpProposer(warper).Propose({"t", views[0].camera}, 0);
  ASSERT_TRUE(proposal.has_value());
  EXPECT_EQ(proposal->name, "t");
  EXPECT_EQ(proposal->source, "warp");
  EXPECT_EQ(proposal->rgb.data, warper.Warp(views[0].camera, 0).rgb.data);
  EXPECT_EQ(proposal->inv_depth.size(), 96u * 72u);
  EXPECT_EQ(proposal->provenance.size(), 96u * 72u);
}

}  // namespace
}  // namespace oraclegs
