#include "oraclegs/scene/rotation.h"

#include <Eigen/Geometry>
#include <limits>

#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

std::string ErrorOf(const Eigen::Matrix3d& matrix) {
  return MessageOf<InputError>([&] { NearestRotation(matrix, "FILE: row 3"); });
}

TEST(NearestRotation, TakesRoundedNumbers) {
  const Eigen::Matrix3d truth = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -2) / 3).toRotationMatrix();
  const Eigen::Matrix3d rounded = (truth * 1000).array().round() / 1000;
  const ReadRotation read = NearestRotation(rounded, "FILE");
  EXPECT_LT((read.rotation - truth).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((read.rotation * read.rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_GT(read.rounding, 1e-5);
  EXPECT_LT(read.rounding, 2e-3);
}

TEST(NearestRotation, SaysWhatAMatrixIsInstead) {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  EXPECT_THAT(ErrorOf(2 * one), HasSubstr("FILE: row 3 is a rotation scaled by 2"));
  EXPECT_THAT(ErrorOf(-one), HasSubstr("is a mirror image of a rotation"));
  EXPECT_THAT(ErrorOf(Eigen::Vector3d(1, 1, 0).asDiagonal()), HasSubstr("is not a rotation"));
  Eigen::Matrix3d nan = one;
  nan(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf(nan), HasSubstr("is not a rotation"));
}

}  // namespace
}  // namespace oraclegs
