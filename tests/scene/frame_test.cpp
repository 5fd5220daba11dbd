#include "oraclegs/scene/frame.h"

#include <gmock/gmock.h>
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

/// Positions times `scale`, then moved.
Scene Rescaled(Scene scene, double scale, const Eigen::Vector3d& offset) {
  SceneFrame frame;
  frame.scale = scale, frame.center = -offset / scale;
  ApplyFrame(frame, &scene);
  return scene;
}

const std::vector<int> kSomeViews{0, 1, 3, 4, 5};

TEST_F(FrameTest, GivenPosesLookAtTheOriginFromFourUnits) {
  const SceneFrame frame = NormalFrame(scene, kSomeViews);
  EXPECT_TRUE(frame.is_given && !frame.is_level);
  EXPECT_EQ(frame.rotation, Eigen::Matrix3d::Identity()) << "what is written back is not turned";
  EXPECT_EQ(frame.offset, Eigen::Vector3d::Zero());
  ApplyFrame(frame, &scene);
  std::vector<double> distances;
  for (const int v : kSomeViews) distances.push_back(PlaceOf(static_cast<size_t>(v)).norm());
  EXPECT_NEAR(Median(&distances), 4, 1e-9);
}

TEST_F(FrameTest, APowerOfTwoChangesNoBitOfTheRun) {
  Scene small = scene;  // ApplyFrame with a scale of 2^-k is exact
  for (SceneView& view : small.views) view.cam_from_world->translation() *= std::ldexp(1., -13);
  for (ScenePoint& point : small.points) point.xyz *= std::ldexp(1., -13);
  ApplyFrame(NormalFrame(small, kSomeViews), &small);
  ApplyFrame(NormalFrame(scene, kSomeViews), &scene);
  for (size_t v = 0; v < scene.views.size(); ++v) {
    EXPECT_EQ(small.views[v].cam_from_world->matrix(), scene.views[v].cam_from_world->matrix());
  }
  for (size_t p = 0; p < scene.points.size(); ++p) EXPECT_EQ(small.points[p].xyz, scene.points[p].xyz);
}

TEST_F(FrameTest, UnitsAndOriginDoNotMatter) {
  Scene normal = scene;
  ApplyFrame(NormalFrame(scene, kSomeViews), &normal);
  for (const double scale : {1e-4, 1e-2, 0.03, 1e3, 1e6}) {
    for (const double far : {0., 1e4, 1e7}) {
      Scene other = Rescaled(scene, scale, scale * far * Eigen::Vector3d(1, -0.5, 0.1));
      const SceneFrame frame = NormalFrame(other, kSomeViews);
      const Scene given = other;
      ApplyFrame(frame, &other);
      const Similarity written_from_run = WrittenFromRun(frame);
      for (size_t p = 0; p < scene.points.size(); p += 40) {
        const double unit = far > 0 ? 1e-6 : 1e-9;  // doubles have 16 digits, 7 of which the offset takes
        EXPECT_NEAR((other.points[p].xyz - normal.points[p].xyz).norm(), 0, unit);
        EXPECT_NEAR((RunFromScene(frame) * given.points[p].xyz - other.points[p].xyz).norm(), 0, unit);
        // Written positions fit into floats.
        const Eigen::Vector3d written = written_from_run * other.points[p].xyz;
        EXPECT_NEAR((written + frame.offset - given.points[p].xyz).norm() * frame.scale, 0, unit);
        EXPECT_LT((written.cast<float>().cast<double>() - written).norm() * frame.scale, 1e-3);
      }
    }
  }
}

TEST_F(FrameTest, FoundPosesAreWrittenInTheRunsCoordinates) {
  const SceneFrame frame = LevelFrame(scene);
  EXPECT_TRUE(WrittenFromRun(frame).IsIdentity() && RunFromScene(frame).IsIdentity());
}

TEST_F(FrameTest, SaysWhyTheScenesOwnUnitsDoNotFit) {
  EXPECT_EQ(WhyUnitsDoNotFit(NormalFrame(scene, kSomeViews)), "");
  const auto why = [&](double scale, double far) {
    return WhyUnitsDoNotFit(NormalFrame(Rescaled(scene, scale, far * Eigen::Vector3d::UnitX()), kSomeViews));
  };
  EXPECT_THAT(why(0.01, 0), testing::HasSubstr("nearer than 0.2"));
  EXPECT_THAT(why(1e6, 0), testing::HasSubstr("too far"));
  EXPECT_THAT(why(1, 1e6), testing::HasSubstr("from its origin"));
}

}  // namespace
}  // namespace oraclegs
