#include "oraclegs/scene/colmap_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

TEST(PoseFromQuaternion, NormalizesItsLength) {
  const Eigen::Isometry3d pose = PoseFromQuaternion({0, 0, 0, 5}, {1, 2, 3}, "images.txt", "a.png");
  EXPECT_TRUE((pose * Eigen::Vector3d(1, 0, 7)).isApprox(Eigen::Vector3d(0, 2, 10), 1e-12));  // half a turn about z
}

TEST(PoseFromQuaternion, NamesAnInvalidPose) {
  const auto message = [](const std::array<double, 4>& wxyz, const Eigen::Vector3d& translation) {
    return MessageOf<InputError>([&] { PoseFromQuaternion(wxyz, translation, "images.txt", "a.png"); });
  };
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message({0, 0, 0, 0}, {1, 2, 3}), HasSubstr("images.txt: the rotation of image 'a.png' is not one"));
  EXPECT_THAT(message({nan, 0, 0, 0}, {1, 2, 3}), HasSubstr("images.txt: the pose of image 'a.png' is not finite"));
  EXPECT_THAT(message({1, 0, 0, 0}, {1, infinity, 3}), HasSubstr("not finite"));
}

}  // namespace
}  // namespace oraclegs
