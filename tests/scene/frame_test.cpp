#include "oraclegs/scene/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/statistics.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

/// A camera at `place` that looks at the origin, its upper side towards -y, before the world is tilted.
Eigen::Isometry3d LookAtOrigin(const Eigen::Vector3d& place) {
  const Eigen::Vector3d forward = -place.normalized(), right = Eigen::Vector3d::UnitY().cross(forward).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().row(0) = right, pose.linear().row(1) = forward.cross(right), pose.linear().row(2) = forward;
  pose.translation() = -(pose.linear() * place);
  return pose;
}

/// Six cameras around the origin and a floor below them, all tilted, shifted and scaled.
class FrameTest : public testing::Test {
 protected:
  FrameTest() {
    for (int i = 0; i < 6; ++i) {
      SceneView view;
      view.name = std::string(1, static_cast<char>('a' + i)) + ".jpg";
      view.cam_from_world = LookAtOrigin({4 * std::sin(0.3 * i), -1.5, -4 * std::cos(0.3 * i)});
      scene.views.push_back(view);
    }
    for (int i = 0; i < 400; ++i) {
      const double x = i % 20 - 9.5, z = i / 20 - 9.5;
      scene.points.push_back({{0.3 * x, 1.0, 0.3 * z}, {}, {}});
      if (i % 4 == 0) scene.points.push_back({{0.1 * x, 0.2 * std::sin(7.0 * i), 0.1 * z}, {}, {}});
    }
    SceneFrame tilt;
    tilt.rotation = Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    tilt.center = {1, -2, 5};
    tilt.scale = 3;
    ApplyFrame(tilt, &scene);
  }

  Eigen::Vector3d PlaceOf(size_t v) const {
    const Eigen::Isometry3d& pose = scene.views[v].cam_from_world.value();
    return -(pose.linear().transpose() * pose.translation());
  }

  Scene scene;
};

TEST_F(FrameTest, LevelsTheFloorAndCentersTheView) {
  const SceneFrame frame = LevelFrame(scene);
  ApplyFrame(frame, &scene);
  EXPECT_TRUE(frame.is_level);
  EXPECT_NEAR((frame.rotation * frame.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(scene.points[5 * i].xyz.y(), scene.points[0].xyz.y(), 1e-6);
  for (size_t v = 0; v < scene.views.size(); ++v) EXPECT_LT(PlaceOf(v).y(), scene.points[0].xyz.y());  // y is down
  // All cameras look at the origin again.
  const Eigen::Isometry3d& pose = scene.views[2].cam_from_world.value();
  EXPECT_NEAR(pose.translation().head<2>().norm(), 0, 1e-6);
}

TEST_F(FrameTest, LevelsByTheCamerasWithoutAFloor) {
  scene.points.clear();
  ApplyFrame(LevelFrame(scene), &scene);
  for (const SceneView& view : scene.views) {
    EXPECT_NEAR(view.cam_from_world->linear()(0, 1), 0, 1e-9) << "the image's horizontal side is level";
    EXPECT_GT(view.cam_from_world->linear()(1, 1), 0) << "its lower side is below";
  }
}

TEST_F(FrameTest, TakesTheMeanUpOfCamerasThatLookOneWay) {
  scene.points.clear();
  for (SceneView& view : scene.views) view.cam_from_world->linear() = scene.views[0].cam_from_world->linear();
  ApplyFrame(LevelFrame(scene), &scene);
  for (const SceneView& view : scene.views) EXPECT_NEAR(view.cam_from_world->linear()(1, 1), 1, 1e-9);
}

TEST_F(FrameTest, KeepsWhatTheCamerasSee) {
  const Eigen::Vector3d before = scene.views[1].cam_from_world.value() * scene.points[7].xyz;
  SceneFrame frame = LevelFrame(scene);
  frame.scale = 0.25;
  ApplyFrame(frame, &scene);
  const Eigen::Vector3d after = scene.views[1].cam_from_world.value() * scene.points[7].xyz;
  EXPECT_NEAR((after - 0.25 * before).norm(), 0, 1e-9);
}

TEST_F(FrameTest, GivesTheSameBitsAgain) { EXPECT_EQ(LevelFrame(scene).rotation, LevelFrame(scene).rotation); }

TEST_F(FrameTest, PutsTheCamerasAtTheUsualDistance) {
  ApplyFrame(LevelFrame(scene), &scene);
  std::vector<double> distances;
  for (size_t v = 0; v < scene.views.size(); ++v) distances.push_back(PlaceOf(v).norm());
  EXPECT_NEAR(Median(distances), 4, 1e-9);
}

TEST_F(FrameTest, MetersComeFromANumberOrADistance) {
  EXPECT_FALSE(UnitMeters(scene, "", false));
  EXPECT_EQ(UnitMeters(scene, "0.01", false), 0.01);
  const double distance = (PlaceOf(0) - PlaceOf(2)).norm();
  EXPECT_DOUBLE_EQ(UnitMeters(scene, "a,c.jpg=0.5", true).value(), 0.5 / distance);
  EXPECT_THROW(UnitMeters(scene, "0.01", true), UsageError) << "units that nobody knows";
}

TEST_F(FrameTest, RefusesOtherLengths) {
  for (const char* text : {"0", "-1", "a", "a=1", "a,b,c=1", "a,b=", "a,b=0", "nan", "=1", ":0,:1=1"}) {
    EXPECT_THROW(CheckScale(text), UsageError) << text;
  }
  EXPECT_NO_THROW(CheckScale(""));
  EXPECT_NO_THROW(CheckScale(scene, "a,b=1"));
  EXPECT_THROW(CheckScale(scene, "a,z=1"), InputError);
  EXPECT_THROW(CheckScale(scene, "a,a.jpg=1"), UsageError) << "one photo";
  EXPECT_THAT(MessageOf<InputError>([&] { UnitMeters(scene, "a,z=1", true); }),
              testing::HasSubstr("the camera of one of these photos was not found"));
  EXPECT_THAT(MessageOf<InputError>([&] { UnitMeters(scene, "a,z=1", false); }), testing::HasSubstr("'z'"))
      << "of a scene with poses";
  scene.views[1].cam_from_world = scene.views[0].cam_from_world;
  EXPECT_THROW(UnitMeters(scene, "a,b=1", true), InputError);
}

TEST(FrameComments, CarryTheUnit) {
  SceneFrame frame;
  EXPECT_TRUE(FrameComments(frame).empty());
  frame.is_level = true, frame.unit_meters = 0.0625;
  std::vector<std::string> comments = FrameComments(frame);
  EXPECT_EQ(comments.size(), 2u);
  EXPECT_EQ(UnitMetersOf(comments), 0.0625);
  comments.push_back("by me");
  const std::string level = comments[0];
  EXPECT_EQ(WithUnit(comments, 1), (std::vector<std::string>{level, "by me", "a unit is 1 m"}));
  EXPECT_EQ(WithUnit(comments, {}), (std::vector<std::string>{level, "by me"}));
  EXPECT_EQ(WithoutLevel(comments), (std::vector<std::string>{"a unit is 0.0625 m", "by me"}));
  for (const char* text : {"a unit is  m", "a unit is long m", "a unit is -1 m", "a unit is 1 mm"}) {
    EXPECT_FALSE(UnitMetersOf({text})) << text;
  }
}

}  // namespace
}  // namespace oraclegs
