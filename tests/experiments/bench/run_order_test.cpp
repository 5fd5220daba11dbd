#include "oraclegs/experiments/bench/run_order.h"

#include <gmock/gmock.h>

#include "experiments/bench/small_bench.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;

class RunOrderTest : public SmallBenchTest {
 protected:
  /// One scene, two seeds: ours of seed 0, 3dgs-mcmc, ours of seed 1, 3dgs-mcmc.
  BenchPlan Plan(const std::string& trajectory) const {
    BenchRequest request = Request();
    request.options.suite = (*scenes / "one").string(), request.options.views = "3";
    request.asked = {{"proposers", "warp"}, {"trajectory", trajectory}};
    return PlanBench(request);
  }
  static FoundResults Found(bool geometry, bool proposals) {
    return {[=](size_t) { return geometry; }, [=](size_t) { return proposals; }};
  }
};

TEST_F(RunOrderTest, SeedsWaitForProposalsThatTheyShare) {
  const BenchPlan plan = Plan("orbit");
  const RunOrder order(plan);
  EXPECT_TRUE(order.SharesProposals(0, 2));
  EXPECT_FALSE(order.SharesProposals(0, 1)) << "another method";
  EXPECT_FALSE(order.SharesProposals(1, 3)) << "has none";
  EXPECT_THAT(order.Ready({0, 1, 2, 3}, {}, Found(false, false)), ElementsAre(0));
  EXPECT_THAT(order.Ready({1, 2, 3}, {0}, Found(false, false)), ElementsAre(1, 2));
  EXPECT_THAT(order.Ready({3}, {0, 1, 2}, Found(false, false)), ElementsAre(3));
}

TEST_F(RunOrderTest, SeedsWithProposalsOfTheirOwnWaitForGeometryAlone) {
  const BenchPlan plan = Plan("coverage");
  const RunOrder order(plan);
  EXPECT_TRUE(order.SharesGeometry(0, 1));
  EXPECT_FALSE(order.SharesGeometry(0, 2)) << "another seed";
  EXPECT_THAT(order.Ready({0, 1, 2, 3}, {}, Found(false, false)), ElementsAre(0, 2));
}

TEST_F(RunOrderTest, NobodyWaitsForWhatIsThere) {
  const BenchPlan plan = Plan("orbit");
  const RunOrder order(plan);
  EXPECT_THAT(order.Ready({1, 2, 3}, {}, Found(true, true)), ElementsAre(1, 2, 3));
  EXPECT_THAT(order.Ready({1, 2, 3}, {}, Found(false, true)), ElementsAre(1, 2)) << "the first of each seed leads";
}

}  // namespace
}  // namespace oraclegs
