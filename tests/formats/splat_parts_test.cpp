#include "oraclegs/formats/splat_parts.h"

#include <Eigen/Geometry>

#include "formats/splats.h"
#include "oraclegs/gaussians/selection.h"

namespace oraclegs {
namespace {

TEST(EvenSimilarity, IsWhatTurnsScalesAndMoves) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  transform.translate(Eigen::Vector3d(1, 2, 3));
  transform.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2).normalized()));
  transform.scale(2);
  const std::optional<Similarity> place = EvenSimilarity(transform.matrix());
  ASSERT_TRUE(place);
  const Eigen::Vector3d point(0.3, -1, 4);
  EXPECT_LT((*place * point - transform * point).norm(), 1e-12);
}

TEST(EvenSimilarity, IsNothingForAMirrorOrUnevenScales) {
  for (const Eigen::Vector3d& scale : {Eigen::Vector3d(1, 1, -1), Eigen::Vector3d(1, 1, 2), Eigen::Vector3d(0, 0, 0)}) {
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    transform.scale(scale);
    EXPECT_FALSE(EvenSimilarity(transform.matrix()));
  }
}

TEST(JoinedParts, FollowEachOtherTurned) {
  const Gaussians g = PlausibleGaussians(5);
  const GaussianPly joined =
      JoinedParts({{Picked(g, {0, 1}), 0, {0.5f, 1}}, {Picked(g, {2, 3, 4}), 2, {0, 0, 0.25f}}}, kTurnAboutX, "f");
  EXPECT_EQ(joined.sh_degree, 2);
  EXPECT_THAT(joined.marks.support, testing::ElementsAre(0.5f, 1, 0, 0, 0.25f));
  ASSERT_EQ(joined.gaussians.size(), 5);
  for (int64_t i = 0; i < 5; ++i) {
    EXPECT_EQ(joined.gaussians.means[3 * i], g.means[3 * i]);
    EXPECT_EQ(joined.gaussians.means[3 * i + 1], -g.means[3 * i + 1]);
  }
}

TEST(JoinedParts, SupportOfAPartIsDropped) {
  const Gaussians g = PlausibleGaussians(2);
  EXPECT_TRUE(JoinedParts({{Picked(g, {0}), 0, {0.5f}}, {Picked(g, {1}), 0, {}}}, 0, "f").marks.support.empty());
}

TEST(JoinedParts, OfNothingAreRefused) {
  EXPECT_THAT(MessageOf<InputError>([] { JoinedParts({}, 0, "f"); }), testing::HasSubstr("f: holds no Gaussians"));
}

}  // namespace
}  // namespace oraclegs
