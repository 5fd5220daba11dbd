#include "oraclegs/networks/seva/orbit.h"

#include "networks/seva/sampling_fixture.h"
#include "oraclegs/camera/camera_path.h"

namespace oraclegs::seva {
namespace {

TEST(SevaOrbit, MatchesTheOfficialOne) {
  const SafetensorsFile file = SamplingFixture();
  const std::vector<View> all = GoldenViews(file, "traj.all_c2w"), orbit = GoldenViews(file, "traj.orbit_c2w");
  std::vector<View> inputs;
  for (const int64_t i : file.Values<int64_t>("traj.train_ids")) inputs.push_back(all.at(static_cast<size_t>(i)));
  const std::vector<double> center = file.Values<double>("traj.lookat"), up = file.Values<double>("traj.up");
  const Eigen::Vector3d our_center = LookAtPoint(all), our_up = UpOf(inputs);
  EXPECT_LE((our_center - Eigen::Map<const Eigen::Vector3d>(center.data())).norm(), 1e-4 * our_center.norm());
  EXPECT_LE((our_up - Eigen::Map<const Eigen::Vector3d>(up.data())).norm(), 1e-4);
  const std::vector<Eigen::Isometry3d> poses =
      Orbit(inputs.front().center(), our_center, our_up, static_cast<int64_t>(orbit.size()));
  for (size_t i = 0; i < orbit.size(); ++i) {
    const Eigen::Matrix4d expected = orbit[i].world_from_camera.matrix();
    EXPECT_LE((poses[i].matrix() - expected).cwiseAbs().maxCoeff(), 1e-4 * expected.cwiseAbs().maxCoeff()) << i;
  }
}

TEST(SevaOrbit, AnchorsLeaveOutTheImage) {
  View input, target;
  input.world_from_camera = LookAt({3, 0, 0}, {0, 0, 0}, {0, 0, 1}).inverse();
  target.world_from_camera = LookAt({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).inverse();
  target.intrinsics(0, 0) = 7;
  const std::vector<View> anchors = OrbitAnchors({input}, {target}, 5);
  ASSERT_EQ(anchors.size(), 5u);
  for (const View& anchor : anchors) {
    EXPECT_NEAR(anchor.center().norm(), 3, 1e-9);
    EXPECT_GE((anchor.center() - input.center()).norm(), 1);
    EXPECT_EQ(anchor.intrinsics, target.intrinsics);
    EXPECT_NEAR(anchor.world_from_camera.linear().determinant(), 1, 1e-9);
  }
}

TEST(SevaOrbit, ParallelAxesMeetBesideTheirMean) {
  std::vector<View> views(2);
  views[1].world_from_camera.translation().x() = 2;
  EXPECT_LE((LookAtPoint(views) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-9);
  EXPECT_THROW(LookAtPoint({}), ShapeError);
  EXPECT_THROW(OrbitAnchors({}, {}, 3), ShapeError);
}

}  // namespace
}  // namespace oraclegs::seva
