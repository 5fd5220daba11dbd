#include "oraclegs/pipeline/stages/proxy_models.h"

#include "pipeline/proposing.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

using OpinionsTest = ProposingTest;

TEST_F(OpinionsTest, LeaveOutEachPhotographOnceAndAreReadBack) {
  auto run = StartRun(Request(), Silent());
  const Preparation prepared = Prepare(&run);
  const TrainOptions options = OpinionOptions(run.options, prepared.decided);
  EXPECT_EQ(options.iterations, 9);  // 0.3 of 30
  EXPECT_EQ(options.schedule, "none");
  const auto first = TrainOpinions(&run, prepared.photos, prepared.geometry, options, "key");
  ASSERT_EQ(first.size(), 3u);
  EXPECT_EQ(first[0].unseen, (std::vector<int>{0, 3, 6, 9}));
  EXPECT_EQ(first[1].unseen, (std::vector<int>{1, 4, 7, 10}));
  EXPECT_FALSE(torch::equal(first[0].gaussians.means, first[1].gaussians.means));
  EXPECT_FALSE(torch::equal(first[0].before.means, first[0].gaussians.means)) << "it went on with all photographs";
  int steps = 0;
  run.listener = [&](const Event& event) { steps += std::holds_alternative<StepDone>(event) ? 1 : 0; };
  const auto again = TrainOpinions(&run, prepared.photos, prepared.geometry, options, "key");
  EXPECT_EQ(steps, 0);
  EXPECT_TRUE(torch::equal(again[1].gaussians.means, first[1].gaussians.means));
  EXPECT_TRUE(torch::equal(again[1].before.means, first[1].before.means));
  // Only what is lost is trained again, to the same bits.
  fs::remove(run.workspace.proposals() / "opinions" / "1_before.ply");
  const auto mended = TrainOpinions(&run, prepared.photos, prepared.geometry, options, "key");
  EXPECT_GT(steps, 0);
  EXPECT_TRUE(torch::equal(mended[1].gaussians.means, first[1].gaussians.means));
}

TEST_F(OpinionsTest, WithoutAFinishAreWhatTheyWereBefore) {
  RunRequest request = Request("unfinished");
  request.options.propose.opinion_finish = 0;
  auto run = StartRun(request, Silent());
  const Preparation prepared = Prepare(&run);
  const auto opinions =
      TrainOpinions(&run, prepared.photos, prepared.geometry, OpinionOptions(run.options, prepared.decided), "key");
  ASSERT_EQ(opinions.size(), 3u);
  EXPECT_TRUE(torch::equal(opinions[0].before.means, opinions[0].gaussians.means));
}

TEST_F(OpinionsTest, SayWhyThereAreNone) {
  auto run = StartRun(Request("none"), recorder.AsListener());
  Preparation prepared = Prepare(&run);
  for (DepthMap& map : prepared.geometry.maps) std::fill(map.confidence.begin(), map.confidence.end(), 0.f);
  EXPECT_THAT(
      TrainOpinions(&run, prepared.photos, prepared.geometry, OpinionOptions(run.options, prepared.decided), "k"),
      IsEmpty());
  EXPECT_THAT(recorder.warnings, Contains(testing::AllOf(
                                     HasSubstr("one would have 8 photographs and 0 dense points, and needs 3 and 1000"),
                                     HasSubstr("photographs are warped instead"))));
}

TEST_F(OpinionsTest, DoNotDependOnHowProposalsAreTrainedOn) {
  RunOptions options = Request().options;
  TrainOptions other = options.train;
  other.synthetic_floor = 0.7, other.proposal_weight = 3, other.confidence_gate = 0.5;
  EXPECT_EQ(OptionsToJson(OpinionOptions(options, other)), OptionsToJson(OpinionOptions(options, options.train)));
}

}  // namespace
}  // namespace oraclegs
