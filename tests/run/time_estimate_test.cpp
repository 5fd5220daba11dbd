#include "oraclegs/run/time_estimate.h"

#include <gtest/gtest.h>

#include "oraclegs/run/stages.h"

namespace oraclegs {
namespace {

class EstimateTest : public testing::Test {
 protected:
  EstimateInput Input(const RunOptions& options) const { return {options, scene, 14, 2, 0, 1, false}; }

  SceneSize scene{12, {4000, 3000}};
  RunOptions options = WithSize({}, scene, {false});
};

TEST_F(EstimateTest, KnowsEveryStage) {
  for (const Stage& stage : Stages()) EXPECT_GT(EstimateSeconds(stage, Input(options)), 0) << stage.name;
  EXPECT_EQ(EstimateSeconds(Stage(), Input(options)), 0) << "its row does not say";
}

TEST_F(EstimateTest, TrainingGrowsWithIterationsPixelsAndGaussians) {
  const double usual = EstimateSeconds(StageNamed(Stages(), "train"), Input(options));
  RunOptions longer = options, larger = options, denser = options;
  longer.train.iterations = 2 * options.train.iterations.value();
  larger.image.max_size = 2 * options.image.max_size.value();
  denser.train.max_gaussians = 2 * options.train.max_gaussians.value();
  EXPECT_NEAR(EstimateSeconds(StageNamed(Stages(), "train"), Input(longer)), 2 * usual, 1e-9 * usual);
  EXPECT_GT(EstimateSeconds(StageNamed(Stages(), "train"), Input(larger)), 2 * usual);
  EXPECT_GT(EstimateSeconds(StageNamed(Stages(), "train"), Input(denser)), 1.1 * usual);
}

TEST_F(EstimateTest, ScalesWithTheMachine) {
  EstimateInput slow = Input(options);
  slow.slowness = 3;
  EXPECT_DOUBLE_EQ(EstimateSeconds(StageNamed(Stages(), "depth"), slow),
                   3 * EstimateSeconds(StageNamed(Stages(), "depth"), Input(options)));
}

TEST_F(EstimateTest, FeaturesOfARegistrationServe) {
  EstimateInput all = Input(options), given = all;
  all.photos = 12, all.test_views = 0;
  given.photos = 0;
  EXPECT_LT(EstimateSeconds(StageNamed(Stages(), "sfm"), all), 1);
  EXPECT_LT(EstimateSeconds(StageNamed(Stages(), "sfm"), Input(options)), 2);
  EXPECT_GT(EstimateSeconds(StageNamed(Stages(), "sfm"), given), 10);
}

TEST_F(EstimateTest, SmallPhotosAreMatchedSooner) {
  const double large = EstimateSeconds(StageNamed(Stages(), "register"), Input(options));
  scene.largest = {320, 240};
  EXPECT_LT(EstimateSeconds(StageNamed(Stages(), "register"), Input(options)), large / 2);
}

TEST_F(EstimateTest, PosesOfViewsAreNoMoreThanThere) {
  const double usual = EstimateSeconds(StageNamed(Stages(), "propose"), Input(options));
  options.trajectory.trajectory = Trajectory::kDataset;
  EstimateInput few = Input(options);
  few.other_views = 3;
  EXPECT_LT(EstimateSeconds(StageNamed(Stages(), "propose"), few), usual / 4);
  options.trajectory.trajectory = {};
  EXPECT_EQ(EstimateSeconds(StageNamed(Stages(), "propose"), Input(options)), usual);
  EstimateInput spare = Input(options);
  spare.other_views = 40;
  EXPECT_LT(EstimateSeconds(StageNamed(Stages(), "propose"), spare), usual / 2);
}

TEST_F(EstimateTest, WithoutProposalsNothingIsProposed) {
  options.propose.proposers = std::string("none");
  EXPECT_EQ(EstimateSeconds(StageNamed(Stages(), "proxies"), Input(options)), 0);
}

TEST_F(EstimateTest, MemoryGrowsWithPixels) {
  RunOptions large = options;
  large.image.max_size = 0;
  EXPECT_GT(EstimateRunMemory(Input(large)), 4 * EstimateRunMemory(Input(options)) / 2);
  EXPECT_GT(EstimateRunMemory(Input(options)), int64_t{500} << 20);  // two photos of 12 megapixels are read at once
  EXPECT_LT(EstimateRunMemory(Input(options)), int64_t{4} << 30);
}

TEST(CpuSlowness, IsMeasuredOnce) {
  const double slowness = CpuSlowness();
  EXPECT_GT(slowness, 0);
  EXPECT_EQ(CpuSlowness(), slowness);
}

}  // namespace

}  // namespace oraclegs
