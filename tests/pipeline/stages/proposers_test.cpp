#include "oraclegs/pipeline/stages/proposers.h"

#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/train/rows.h"
#include "pipeline/proposing.h"

namespace oraclegs {
namespace {

using ProposersTest = ProposingTest;

TEST_F(ProposersTest, AskEachProposerForEachTarget) {
  auto run = StartRun(Request(), Silent());
  const Preparation prepared = Prepare(&run);
  const Gaussians blob = InitializeGaussians(
      ToPointCloud(prepared.sfm.size() > 3 ? prepared.sfm : std::vector<ScenePoint>(4)), {1, 0.5, 1});
  const Proposers both(run, prepared.photos, prepared.geometry,
                       {{Clone(blob), Clone(blob), {0}}, {Clone(blob), Clone(blob), {1}}});
  const Target first{"first", prepared.photos[0].camera}, third{"third", prepared.photos[2].camera};
  const auto answers = both.Ask({first, third, third}, {0, -1, 2});
  ASSERT_EQ(answers.size(), 3u);
  ASSERT_EQ(answers[0].size(), 2u);
  EXPECT_EQ(answers[0][0].source, "warp");
  EXPECT_EQ(answers[0][1].source, "splat");
  EXPECT_EQ(answers[0][1].name, "first");
  EXPECT_EQ(answers[1].size(), 2u);
  EXPECT_EQ(answers[2].size(), 1u);  // every opinion has seen the third photograph
  run.options.propose.proposers = "splat";
  const Proposers one(run, prepared.photos, prepared.geometry, {{Clone(blob), Clone(blob), {0}}});
  EXPECT_EQ(one.Ask({first}, {-1})[0].size(), 1u);
}

}  // namespace
}  // namespace oraclegs
