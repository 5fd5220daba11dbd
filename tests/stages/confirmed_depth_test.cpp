#include "oraclegs/stages/confirmed_depth.h"

#include <gtest/gtest.h>

#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

TEST(ConfirmedDepth, IsLostByAMisplacedView) {
  const TempDir dir;
  const Scene scene = WriteTexturedPlanes(dir.path(), 4);
  const std::vector<double> right = ConfirmedDepth(scene, kCpu);
  ASSERT_EQ(right.size(), 4u);
  for (const double share : right) EXPECT_GT(share, .3);

  Scene wrong = scene;
  wrong.views[1].cam_from_world->prerotate(Eigen::AngleAxisd(.2, Eigen::Vector3d::UnitX()));
  const std::vector<double> shares = ConfirmedDepth(wrong, kCpu);
  EXPECT_LT(shares[1], .05);
  for (const size_t view : {0u, 2u, 3u}) EXPECT_GT(shares[view], .2) << view;

  Scene far = scene;  // the unit of a model is open
  for (SceneView& view : far.views) view.cam_from_world->translation() *= 128;
  EXPECT_NEAR(ConfirmedDepth(far, kCpu)[0], right[0], 1e-6);
}

}  // namespace
}  // namespace oraclegs
