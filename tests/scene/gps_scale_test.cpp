#include "oraclegs/scene/gps_scale.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/scene/frame.h"

namespace oraclegs {
namespace {

constexpr double kMetersPerDegree = 111319.4908;  // of longitude, at the equator (WGS 84)

/// A walk around something: places in units, and GPS positions at the equator of `meters` a unit, turned by a quarter.
class GpsScaleTest : public testing::Test {
 protected:
  void Walk(int views, double meters, double noise_meters = 0) {
    scene.views.clear();
    for (int i = 0; i < views; ++i) {
      const double x = 4 * std::cos(0.7 * i), z = 4 * std::sin(0.7 * i);
      SceneView view;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = -Eigen::Vector3d(x, 0.1 * i, z);
      view.cam_from_world = pose;
      const double noise = noise_meters * std::sin(5.0 * i * i + 1);
      // A quarter turn to the left: x is north, z is west. Beyond the date line on the way.
      const double east = -z * meters + noise, north = x * meters - noise;
      const double longitude = 180 + east / kMetersPerDegree;
      const double height = 300 - 0.1 * i * meters;
      view.gps = GpsPosition{north / 110574.2758, longitude > 180 ? longitude - 360 : longitude, height};
      scene.views.push_back(view);
    }
  }

  Scene scene;
};

TEST_F(GpsScaleTest, FindsTheLengthOfAUnit) {
  Walk(8, 6.5);
  const auto scale = UnitMetersByGps(scene);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->unit_meters, 6.5, 1e-4);
  EXPECT_LT(scale->error, 1e-4);
  EXPECT_EQ(scale->views, 8);
}

TEST_F(GpsScaleTest, KnowsItsError) {
  Walk(20, 10, 2);
  const auto scale = UnitMetersByGps(scene);
  ASSERT_TRUE(scale);
  EXPECT_GT(scale->error, 0.003);
  EXPECT_NEAR(scale->unit_meters, 10, 3 * scale->error * 10);
}

TEST_F(GpsScaleTest, SaysNothingOfAMirroredWalk) {
  Walk(8, 6.5);
  for (SceneView& view : scene.views) view.gps->latitude *= -1;
  EXPECT_FALSE(UnitMetersByGps(scene));
}

TEST_F(GpsScaleTest, SaysNothingOfARoom) {
  Walk(8, 0.5);
  EXPECT_FALSE(UnitMetersByGps(scene));
}

TEST_F(GpsScaleTest, SaysNothingWherePositionsDisagree) {
  Walk(8, 6.5, 15);
  EXPECT_FALSE(UnitMetersByGps(scene));
}

TEST_F(GpsScaleTest, SaysNothingOfFewPositions) {
  Walk(8, 6.5);
  for (size_t i = 0; i < 4; ++i) scene.views[i].gps.reset();
  EXPECT_FALSE(UnitMetersByGps(scene));
  EXPECT_FALSE(UnitMetersByGps(Scene()));
}

TEST_F(GpsScaleTest, SaysNothingOfOnePlace) {
  Walk(8, 6.5);
  for (SceneView& view : scene.views) view.cam_from_world->translation().setZero();
  EXPECT_FALSE(UnitMetersByGps(scene));
  Walk(8, 6.5);
  for (SceneView& view : scene.views) view.gps = GpsPosition{0, 0, 100};
  EXPECT_FALSE(UnitMetersByGps(scene));
}

TEST_F(GpsScaleTest, HeightsTellUp) {
  Walk(8, 6.5, 0.2);
  const auto up = UpByGps(scene);
  ASSERT_TRUE(up);
  EXPECT_GT(up->dot(-Eigen::Vector3d::UnitY()), 0.999);
  EXPECT_NEAR(up->norm(), 1, 1e-9);
  for (SceneView& view : scene.views) view.gps->altitude.reset();
  EXPECT_FALSE(UpByGps(scene));
}

TEST_F(GpsScaleTest, ALineTellsNoUp) {
  Walk(8, 6.5);
  for (size_t i = 0; i < scene.views.size(); ++i) {
    const auto along = static_cast<double>(i);
    scene.views[i].cam_from_world->translation() = -Eigen::Vector3d(along, 0, 0);
    scene.views[i].gps = GpsPosition{0, 10 * along / kMetersPerDegree, 300};
  }
  EXPECT_TRUE(UnitMetersByGps(scene));
  EXPECT_FALSE(UpByGps(scene));
}

TEST_F(GpsScaleTest, LevelsAMapFlight) {
  Walk(9, 10);
  Eigen::Isometry3d tilt = Eigen::Isometry3d::Identity();
  tilt.linear() = Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (SceneView& view : scene.views) {
    const Eigen::Vector3d place = -view.cam_from_world->translation();
    Eigen::Isometry3d down = Eigen::Isometry3d::Identity();  // looks along y, its upper side always north
    down.linear() << 0, 0, -1, -1, 0, 0, 0, 1, 0;
    down.translation() = -(down.linear() * place);
    view.cam_from_world = down * tilt.inverse(Eigen::Isometry);
  }
  ApplyFrame(LevelFrame(scene), &scene);
  for (const SceneView& view : scene.views) {
    EXPECT_GT(view.cam_from_world->linear().row(2).dot(Eigen::RowVector3d::UnitY()), 0.999) << "it looks down";
  }
  EXPECT_TRUE(UnitMetersByGps(scene));
}

}  // namespace
}  // namespace oraclegs
