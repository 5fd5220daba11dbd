#include "oraclegs/output/live/early_splat.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/run/start.h"
#include "run/fixtures.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

class EarlySplatTest : public testing::Test {
 protected:
  TempDir temp;
  EventRecorder recorder;
  oraclegs::Run run = StartRun(TinyRequest(MakeTinyScene(temp / "scene"), temp / "out"), recorder.AsListener());
};

TEST_F(EarlySplatTest, ShowsPointsAsDots) {
  run.results->points.clear();
  for (int i = 0; i < 50; ++i) run.results->points.push_back({Eigen::Vector3d(0.1 * i, 0, 2), {255, 0, 0}, {}});
  run.results->points.push_back({Eigen::Vector3d(900, 0, 2), {0, 255, 0}, {}});
  const EarlySplat sparse = EarlySplatOf(run, "sfm");
  EXPECT_EQ(sparse.of, "sparse points");
  ASSERT_EQ(sparse.gaussians.size(), 51);
  EXPECT_NEAR(std::exp(sparse.gaussians.log_scales[3]), 0.024, 0.012) << "a fifth of the neighbors' distance";
  EXPECT_LT(std::exp(sparse.gaussians.log_scales[150]), 0.3) << "one that is far from all others is no balloon";
  EXPECT_EQ(EarlySplatOf(run, "depth").gaussians.size(), 0) << "no point was found";
}

TEST_F(EarlySplatTest, ThinsMany) {
  DensePoint point{};
  point.rgb = {0.2f, 0.4f, 0.6f}, point.normal = {0, 0, -1};
  for (int i = 0; i < 250000; ++i) {
    point.xyz = {0.01f * static_cast<float>(i), 0, 2};
    run.results->geometry.points.push_back(point);
  }
  const EarlySplat dense = EarlySplatOf(run, "depth");
  EXPECT_EQ(dense.of, "dense points");
  EXPECT_EQ(dense.gaussians.size(), 100000);
}

TEST_F(EarlySplatTest, HasNothingOfOtherStages) {
  for (const char* stage : {"photos", "register", "poses", "proxies", "validate", "train"}) {
    EXPECT_EQ(EarlySplatOf(run, stage).gaussians.size(), 0) << stage;
  }
}

}  // namespace
}  // namespace oraclegs
