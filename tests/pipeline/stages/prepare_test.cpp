#include "oraclegs/pipeline/stages/prepare.h"

#include "pipeline/proposing.h"

namespace oraclegs {
namespace {

using testing::IsEmpty;
using PrepareTest = ProposingTest;

TEST_F(PrepareTest, FindsDepthWhereALaterStageNeedsItAndDecidesWhatIsAutomatic) {
  auto run = StartRun(Request(), Silent());
  const Preparation prepared = Prepare(&run);
  ASSERT_EQ(prepared.photos.size(), 12u);
  EXPECT_EQ(prepared.photos[0].name, run.scene.views[static_cast<size_t>(run.split.train[0])].name);
  EXPECT_EQ(prepared.geometry.maps.size(), 12u);
  EXPECT_GE(prepared.decided.opacity_noise, 0);
  EXPECT_NE(prepared.decided.exposure, "auto");
}

TEST_F(PrepareTest, LooksForNoDepthThatNobodyNeeds) {
  auto request = Request("bare");
  request.options.propose.proposers = "none";
  request.options.start.init = "random";
  request.options.train.depth_weight = 0;
  auto run = StartRun(request, Silent());
  EXPECT_THAT(Prepare(&run).geometry.maps, IsEmpty());
}

}  // namespace
}  // namespace oraclegs
