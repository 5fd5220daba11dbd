#include "oraclegs/stages/proposers.h"

#include "oraclegs/gaussians/initialize.h"
#include "run/proposing.h"

namespace oraclegs {
namespace {

using ProposersTest = ProposingTest;

TEST_F(ProposersTest, AskEachProposerForEachTarget) {
  auto run = StartRun(Request(), Silent());
  const StageResults& known = Bring(&run, "depth");
  const TrainingViews& training = ViewsOf(&run);
  const Gaussians blob = InitializeGaussians(
      ToPointCloud(known.points.size() > 3 ? known.points : std::vector<ScenePoint>(4)), {1, 0.5, 1});
  const Proposers both(run, training, known.geometry,
                       {{blob.Clone(), blob.Clone(), {0}}, {blob.Clone(), blob.Clone(), {1}}});
  const Target first{"first", training.views[0].camera}, third{"third", training.views[2].camera};
  const auto candidates = both.Ask({first, third, third}, {0, std::nullopt, 2});
  ASSERT_EQ(candidates.size(), 3u);
  ASSERT_EQ(candidates[0].size(), 2u);
  EXPECT_EQ(candidates[0][0].source, "warp");
  EXPECT_EQ(candidates[0][1].source, "splat");
  EXPECT_EQ(candidates[0][1].name, "first");
  EXPECT_EQ(candidates[1].size(), 2u);
  EXPECT_EQ(candidates[2].size(), 1u);  // the third view is held out from no member
  EXPECT_TRUE(both.has_proxy_models());
  EXPECT_EQ(both.ProxyRender(first)->source, "splat");
  const Proposers without(run, training, known.geometry, {});
  EXPECT_FALSE(without.has_proxy_models());
  EXPECT_FALSE(without.ProxyRender(first).has_value());
  run.options.propose.proposers = ProposerChoice::kSplat;
  const Proposers one(run, training, known.geometry, {{blob.Clone(), blob.Clone(), {0}}});
  EXPECT_EQ(one.Ask({first})[0].size(), 1u);
}

}  // namespace
}  // namespace oraclegs
