#include "oraclegs/depth/gains.h"

#include <gtest/gtest.h>

#include "depth/rig.h"

namespace oraclegs {
namespace {

const TexturedPlane kGainWall{{0, 0, 0.5}, Eigen::Vector3d(0.2, -0.1, -1).normalized()};

class GainsTest : public testing::Test {
 protected:
  /// Another camera that sees the wall, its image darkened by `gain`.
  void Add(double x, const Eigen::Vector3f& gain) {
    const Camera camera = CameraAt({x, 0.05 * x, -4}, {0, 0, 0});
    LoadedView view = kGainWall.Take(camera, std::to_string(views.size()));
    DepthMap map{view.name, camera, {}, {}, {}};
    for (int i = 0; i < camera.width * camera.height; ++i) {
      const double depth = kGainWall.DepthAt(camera, i % camera.width + 0.5, i / camera.width + 0.5);
      map.inv_depth.push_back(static_cast<float>(1 / depth));
      map.normals.emplace_back(0, 0, -1);
      map.confidence.push_back(1);
      for (int c = 0; c < 3; ++c) view.rgb.data[3 * static_cast<size_t>(i) + c] *= gain[c];
    }
    views.push_back(std::move(view));
    maps.push_back(std::move(map));
  }

  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
};

TEST_F(GainsTest, AreOneForEqualExposure) {
  for (const double x : {-0.6, 0., 0.6}) Add(x, {1, 1, 1});
  for (const Eigen::Vector3f& gain : EstimateGains(maps, views)) {
    EXPECT_LT((gain - Eigen::Vector3f::Ones()).norm(), 0.01);
  }
  EXPECT_LT(ExposureSpread(EstimateGains(maps, views)), 0.005);
}

TEST_F(GainsTest, RecoverExposure) {
  const std::vector<Eigen::Vector3f> truth{{1, 0.9f, 0.7f}, {0.6f, 0.7f, 0.8f}, {0.8f, 0.8f, 0.8f}};
  for (size_t v = 0; v < 3; ++v) Add(0.6 * static_cast<double>(v) - 0.6, truth[v]);
  const std::vector<Eigen::Vector3f> gains = EstimateGains(maps, views);
  for (size_t a = 0; a < 3; ++a) {
    for (size_t b = 0; b < 3; ++b) {  // only ratios can be known
      const Eigen::Vector3f found = gains[a].cwiseQuotient(gains[b]), expected = truth[a].cwiseQuotient(truth[b]);
      EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 0.02) << a << " " << b;
    }
  }
  EXPECT_NEAR((gains[0].array() * gains[1].array() * gains[2].array()).log().matrix().norm(), 0, 1e-4);
  EXPECT_GT(ExposureSpread(gains), 0.08);
}

TEST_F(GainsTest, AreOneWithoutOverlap) {
  Add(-0.3, {1, 1, 1});
  Add(0.3, {0.5f, 0.5f, 0.5f});
  std::fill(maps[1].confidence.begin(), maps[1].confidence.end(), 0.f);
  for (const Eigen::Vector3f& gain : EstimateGains(maps, views)) EXPECT_EQ(gain, Eigen::Vector3f::Ones());
  EXPECT_TRUE(EstimateGains({}, {}).empty());
  EXPECT_EQ(ExposureSpread({}), 0);
}

TEST_F(GainsTest, RecoverExposureOfViewWithoutDepth) {
  for (const double x : {-0.6, 0., 0.6}) Add(x, {1, 1, 1});
  Add(0.3, {0.6f, 0.7f, 0.8f});
  maps.back() = {maps.back().name, maps.back().camera, {}, {}, {}};
  const std::vector<Eigen::Vector3f> gains = EstimateGains(maps, views);
  const Eigen::Vector3f found = gains[3].cwiseQuotient(gains[0]);
  EXPECT_LT((found - Eigen::Vector3f(0.6f, 0.7f, 0.8f)).cwiseAbs().maxCoeff(), 0.02);
}

}  // namespace
}  // namespace oraclegs
