#include "oraclegs/scene/transforms_frame.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using nlohmann::json;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Intrinsics LensOf(const json& file, const json& frame = json::object(),
                  const std::filesystem::path& image = "unread.png") {
  return ReadTransformsIntrinsics({file, frame, "FILE: frame 'x'"}, image);
}

Eigen::Isometry3d PoseOf(const json& matrix) {
  const json file = json::object();
  const json frame = {{"transform_matrix", matrix}};
  return ReadTransformsPose({file, frame, "FILE: frame 'x'"}).cam_from_world;
}

json MatrixOf(const Eigen::Matrix3d& r, const Eigen::Vector3d& t) {
  json matrix = json::array();
  for (int i = 0; i < 3; ++i) matrix.push_back({r(i, 0), r(i, 1), r(i, 2), t(i)});
  matrix.push_back({0, 0, 0, 1});
  return matrix;
}

TEST(ReadTransformsIntrinsics, ChoosesTheModelByItsCoefficients) {
  const json base = {{"fl_x", 50}, {"fl_y", 60}, {"cx", 31.5}, {"cy", 20}, {"w", 64.0}, {"h", 40}};
  const Intrinsics pinhole = LensOf(base);
  EXPECT_EQ(pinhole.model, CameraModel::kPinhole);
  EXPECT_EQ(pinhole.width, 64);
  EXPECT_EQ(pinhole.height, 40);
  EXPECT_THAT(pinhole.params, ElementsAre(50, 60, 31.5, 20));

  json distorted = base;
  distorted.update({{"k1", 0.1}, {"k2", -0.2}, {"p1", 0.01}, {"p2", 0.02}});
  EXPECT_EQ(LensOf(distorted).model, CameraModel::kOpenCv);
  EXPECT_THAT(LensOf(distorted).params, ElementsAre(50, 60, 31.5, 20, 0.1, -0.2, 0.01, 0.02));

  distorted["k3"] = 0.3;
  EXPECT_EQ(LensOf(distorted).model, CameraModel::kFullOpenCv);
  EXPECT_THAT(LensOf(distorted).params, ElementsAre(50, 60, 31.5, 20, 0.1, -0.2, 0.01, 0.02, 0.3, 0, 0, 0));

  distorted["k4"] = 0.4;
  EXPECT_THAT(MessageOf<InputError>([&] { LensOf(distorted); }), HasSubstr("FILE: frame 'x': \"k4\""));
  distorted["camera_model"] = "OPENCV_FISHEYE";
  EXPECT_EQ(LensOf(distorted).model, CameraModel::kOpenCvFisheye);
  EXPECT_THAT(LensOf(distorted).params, ElementsAre(50, 60, 31.5, 20, 0.1, -0.2, 0.3, 0.4));
  distorted["camera_model"] = "PINHOLE";
  distorted["is_fisheye"] = true;
  EXPECT_EQ(LensOf(distorted).model, CameraModel::kOpenCvFisheye);
}

TEST(ReadTransformsIntrinsics, FillsInFocalLengthsAndCenter) {
  EXPECT_THAT(LensOf({{"fl_x", 50}, {"w", 64}, {"h", 40}}).params, ElementsAre(50, 50, 32, 20));
  EXPECT_THAT(LensOf({{"fl_y", 50}, {"w", 64}, {"h", 40}}).params, ElementsAre(50, 50, 32, 20));
  const double right_angle = std::numbers::pi / 2;  // half the width over tan 45 degrees
  const Intrinsics square = LensOf({{"camera_angle_x", right_angle}, {"w", 64}, {"h", 40}});
  EXPECT_THAT(square.params, ElementsAre(DoubleNear(32, 1e-12), DoubleNear(32, 1e-12), 32, 20));
  const Intrinsics height_only = LensOf({{"camera_angle_y", right_angle}, {"w", 64}, {"h", 40}});
  EXPECT_THAT(height_only.params, ElementsAre(DoubleNear(20, 1e-12), DoubleNear(20, 1e-12), 32, 20));
  const Intrinsics both =
      LensOf({{"camera_angle_x", right_angle}, {"camera_angle_y", right_angle}, {"w", 64}, {"h", 40}});
  EXPECT_THAT(both.params, ElementsAre(DoubleNear(32, 1e-12), DoubleNear(20, 1e-12), 32, 20));
  // The length in pixels is the exact one; the angle beside it was derived from it.
  EXPECT_EQ(LensOf({{"fl_x", 50}, {"fl_y", 50}, {"camera_angle_x", 1.0}, {"w", 64}, {"h", 40}}).fx(), 50);
}

TEST(ReadTransformsIntrinsics, PrefersTheFrameToTheFile) {
  const json file = {{"fl_x", 50}, {"fl_y", 60}, {"cx", 30}, {"cy", 20}, {"w", 64}, {"h", 40}, {"k1", 0.1}};
  const Intrinsics intrinsics = LensOf(file, {{"fl_x", 70}, {"cx", 33}, {"k1", 0}});
  EXPECT_THAT(intrinsics.params, ElementsAre(70, 70, 33, 20));
  const Intrinsics angle = LensOf(file, {{"camera_angle_x", std::numbers::pi / 2}});
  EXPECT_NEAR(angle.fx(), 32, 1e-12);
}

TEST(ReadTransformsIntrinsics, TakesTheSizeFromTheImage) {
  TempDir dir;
  WriteImage(dir / "x.png", 14, 10);
  const Intrinsics intrinsics = LensOf({{"camera_angle_x", std::numbers::pi / 2}}, json::object(), dir / "x.png");
  EXPECT_EQ(intrinsics.width, 14);
  EXPECT_EQ(intrinsics.height, 10);
  EXPECT_THAT(intrinsics.params, ElementsAre(DoubleNear(7, 1e-12), DoubleNear(7, 1e-12), 7, 5));
}

TEST(ReadTransformsIntrinsics, RefusesBadNumbers) {
  const auto message = [](const json& file) { return MessageOf<InputError>([&] { LensOf(file); }); };
  EXPECT_THAT(message({{"fl_x", 0}, {"w", 64}, {"h", 40}}), HasSubstr("FILE: frame 'x'"));
  EXPECT_THAT(message({{"fl_x", -5}, {"w", 64}, {"h", 40}}), HasSubstr("FILE: frame 'x'"));
  EXPECT_THAT(message({{"fl_x", "NaN"}, {"w", 64}, {"h", 40}}), HasSubstr("\"fl_x\" is not a finite number"));
  EXPECT_THAT(message({{"w", 64}, {"h", 40}}), HasSubstr("no focal length"));
  EXPECT_THAT(message({{"camera_angle_x", 4}, {"w", 64}, {"h", 40}}), HasSubstr("between 0 and pi"));
  EXPECT_THAT(message({{"camera_angle_y", 4}, {"w", 64}, {"h", 40}}), HasSubstr("\"camera_angle_y\" is 4"));
  EXPECT_THAT(message({{"fl_x", 5}, {"w", 64.5}, {"h", 40}}), HasSubstr("\"w\" is 64.5"));
  EXPECT_THAT(message({{"fl_x", 5}, {"w", 1e18}, {"h", 40}}), HasSubstr("whole number"));
  EXPECT_THAT(message({{"fl_x", 5}, {"w", 64}, {"h", 40}, {"camera_model", "ORTHOPHOTO"}}),
              HasSubstr("'ORTHOPHOTO' is not supported; undistort the photos to PINHOLE first"));
  EXPECT_THAT(message({{"fl_x", 5}, {"w", 64}, {"h", 40}, {"camera_model", "FISHEYE624"}}),
              HasSubstr("'FISHEYE624' is not supported; undistort the photos to PINHOLE first"));
  EXPECT_THAT(message({{"fl_x", 5}, {"w", 64}, {"h", 40}, {"camera_model", 3}}), HasSubstr("is not text"));
}

TEST(ReadTransformsPose, ConvertsOpenGlAxes) {
  // An OpenGL camera at (0, 0, 5) without rotation looks along -z, at the origin, with world y up in the image.
  const Eigen::Isometry3d pose = PoseOf(MatrixOf(Eigen::Matrix3d::Identity(), {0, 0, 5}));
  EXPECT_TRUE((pose * Eigen::Vector3d(0, 0, 0)).isApprox(Eigen::Vector3d(0, 0, 5), 1e-14));
  EXPECT_TRUE((pose * Eigen::Vector3d(1, 2, 0)).isApprox(Eigen::Vector3d(1, -2, 5), 1e-14));
}

TEST(ReadTransformsPose, MakesARoundedRotationExact) {
  Eigen::Matrix3d r = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -3).normalized()).toRotationMatrix();
  const Eigen::Matrix3d rounded = (r * 1e5).array().round().matrix() / 1e5;
  const Eigen::Vector3d center(1, 2, 3);
  json three_rows = MatrixOf(rounded, center);
  three_rows.erase(3);
  const Eigen::Isometry3d pose = PoseOf(three_rows);
  EXPECT_TRUE((pose.linear() * pose.linear().transpose()).isIdentity(1e-14));
  EXPECT_NEAR(pose.linear().determinant(), 1, 1e-14);
  EXPECT_LT((pose * center).norm(), 1e-14);
  EXPECT_TRUE(pose.linear().transpose().col(0).isApprox(r.col(0), 1e-4));
}

TEST(ReadTransformsPose, TakesTheRotationNearestToTwoDecimals) {
  const Eigen::Matrix3d r = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -3).normalized()).toRotationMatrix();
  const json file = json::object();
  const json frame = {{"transform_matrix", MatrixOf((r * 1e2).array().round().matrix() / 1e2, {1, 2, 3})}};
  const TransformsPose pose = ReadTransformsPose({file, frame, "FILE: frame 'x'"});
  EXPECT_TRUE((pose.cam_from_world.linear() * pose.cam_from_world.linear().transpose()).isIdentity(1e-14));
  EXPECT_GT(pose.rounding, 1e-4);
  EXPECT_LT(pose.rounding, 1e-2);
}

TEST(ReadTransformsPose, NamesTheFault) {
  const auto message = [](const json& matrix) { return MessageOf<InputError>([&] { PoseOf(matrix); }); };
  const Eigen::Matrix3d r = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::Vector3d t(1, 2, 3);
  EXPECT_THAT(message(MatrixOf(2.5 * r, t)),
              HasSubstr("FILE: frame 'x': \"transform_matrix\" is a rotation scaled by 2.5"));
  EXPECT_THAT(message(MatrixOf(-r, t)), HasSubstr("mirror image"));
  Eigen::Matrix3d sheared = r;
  sheared(0, 1) += 0.2;
  EXPECT_THAT(message(MatrixOf(sheared, t)), HasSubstr("is not a rotation"));
  EXPECT_THAT(message(MatrixOf(Eigen::Matrix3d::Zero(), t)), HasSubstr("is not a rotation"));
  EXPECT_THAT(message(MatrixOf(1e200 * r, t)), HasSubstr("transform_matrix"));
  json with_text = MatrixOf(r, t);
  with_text[1][2] = "NaN";
  EXPECT_THAT(message(with_text), HasSubstr("\"transform_matrix\" is not a finite number"));
  json short_row = MatrixOf(r, t);
  short_row[2].erase(0);
  EXPECT_THAT(message(short_row), HasSubstr("row 2"));
  json bad_last = MatrixOf(r, t);
  bad_last[3][0] = 1;
  EXPECT_THAT(message(bad_last), HasSubstr("last row"));
  EXPECT_THAT(message(json::array({1, 2})), HasSubstr("3 or 4 rows"));
  EXPECT_THAT(message(nullptr), HasSubstr("missing"));
}

}  // namespace
}  // namespace oraclegs
