#include "oraclegs/pipeline/stages/perceptual.h"

#include "oraclegs/networks/common/recognize.h"
#include "pipeline/fixtures.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

class PerceptualTest : public testing::Test {
 protected:
  void SetUp() override { torch::manual_seed(11); }
  std::vector<TrainView> Proposals(int side) const {
    TrainView view;
    view.name = "a", view.camera.width = side, view.camera.height = side + 2;
    return {view};
  }

  TempDir temp;
  std::filesystem::path file = WriteTinyLpips(temp / "lpips.safetensors");
  Tensor render = torch::rand({30, 40, 3}), target = torch::rand({30, 40, 3});
  EventRecorder recorder;
};

TEST_F(PerceptualTest, TheLossIsLpipsOfPicturesAsTheyAre) {
  const Lpips lpips = LoadRecognizedLpips({file});
  Tensor expected = torch::zeros_like(render);
  const double value = Distance(lpips, render, PrepareTarget(lpips, target, LpipsRange::kZeroOne), &expected).value;
  const PerceptualDistance loss = LpipsLoss({file});
  Tensor grad = torch::ones_like(render), none;
  EXPECT_EQ(loss(render, target, 0.25, &grad), value);
  EXPECT_LT(MaxAbsError(grad, 1 + 0.25 * expected), 1e-7) << "adds to what is there";
  EXPECT_EQ(loss(render, target, 1, nullptr), value);
  EXPECT_EQ(loss(render, target, 1, &none), value);
}

TEST_F(PerceptualTest, KeptFeaturesChangeNothing) {
  const Tensor other = torch::rand({24, 30, 3}), small = torch::rand({24, 30, 3});
  const PerceptualDistance kept = LpipsLoss({file}), anew = LpipsLoss({file}, 0);
  for (int round = 0; round < 2; ++round) {
    Tensor a = torch::zeros_like(render), b = torch::zeros_like(render);
    EXPECT_EQ(kept(render, target, 1, &a), anew(render, target, 1, &b));
    EXPECT_TRUE(torch::equal(a, b));
    EXPECT_EQ(kept(small, other, 1, nullptr), anew(small, other, 1, nullptr));
  }
  // Beyond the cache's size, too, and where a target was kept and another comes in another size to the same place.
  const PerceptualDistance little = LpipsLoss({file}, 30 * 40 * 4 * 10);
  EXPECT_EQ(little(render, target, 1, nullptr), anew(render, target, 1, nullptr));
  EXPECT_EQ(little(small, other, 1, nullptr), anew(small, other, 1, nullptr));
  const Tensor part = target.slice(0, 0, 20);
  EXPECT_EQ(kept(render.slice(0, 0, 20), part, 1, nullptr), anew(render.slice(0, 0, 20), part, 1, nullptr));
}

TEST_F(PerceptualTest, ProposalsAskItWhereThereAreWeightsAndAShare) {
  RunOptions options;
  options.weights.lpips_weights = file;
  const TrainingLpips lpips = LpipsOfProposals(options, Proposals(40), recorder.AsListener());
  EXPECT_TRUE(lpips.distance);
  EXPECT_EQ(lpips.convention, "VGG16, pictures in [0, 1]");
  EXPECT_FALSE(LpipsOfProposals(options, {}, Silent()).distance);
  RunOptions without = options;
  without.train.proposal_lpips = 0;
  EXPECT_FALSE(LpipsOfProposals(without, Proposals(40), Silent()).distance);
  without = options, without.train.schedule = ScheduleKind::kNone;
  EXPECT_FALSE(LpipsOfProposals(without, Proposals(40), Silent()).distance);
  EXPECT_FALSE(LpipsOfProposals({}, Proposals(40), recorder.AsListener()).distance) << "no weights";
  EXPECT_TRUE(recorder.warnings.empty());
  options.weights.lpips_weights = temp / "none";
  EXPECT_THAT(MessageOf<InputError>([&] { LpipsOfProposals(options, Proposals(40), Silent()); }),
              HasSubstr("does not exist"));
}

TEST_F(PerceptualTest, ProposalsThatAreTooSmallDoWithoutIt) {
  RunOptions options;
  options.weights.lpips_weights = file;
  EXPECT_TRUE(LpipsOfProposals(options, Proposals(16), recorder.AsListener()).distance);
  EXPECT_TRUE(recorder.warnings.empty());
  options.train.coarse_share = 0.3;
  EXPECT_FALSE(LpipsOfProposals(options, Proposals(16), recorder.AsListener()).distance);
  ASSERT_EQ(recorder.warnings.size(), 1u);
  EXPECT_THAT(recorder.warnings[0], HasSubstr("proposals of 8 pixels a side are too small for LPIPS, which needs 16"));
}

TEST_F(PerceptualTest, ScoresAreOfBothConventionsAndSaySo) {
  const ImageScores scores = LpipsScores({file});
  const Lpips lpips = LoadRecognizedLpips({file});
  const std::map<std::string, double> values = scores.of(render, target);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values.at("lpips"), Distance(lpips, render, PrepareTarget(lpips, target, LpipsRange::kZeroOne)).value);
  EXPECT_EQ(values.at("lpips_minus1_1"),
            Distance(lpips, render, PrepareTarget(lpips, target, LpipsRange::kMinusOneOne)).value);
  EXPECT_THAT(scores.conventions.at("lpips"), HasSubstr("VGG16, pictures in [0, 1]"));
  EXPECT_THAT(scores.conventions.at("lpips_minus1_1"), HasSubstr("[-1, 1]"));
  EXPECT_EQ(scores.smallest_side, 16);
  EXPECT_FALSE(LpipsScores({}).of);
  const auto alex = WriteTinyLpips(temp / "alex.safetensors", 7, FeatureNetwork::kAlexNet);
  EXPECT_THAT(LpipsScores({alex}).conventions.at("lpips"), HasSubstr("AlexNet"));
}

}  // namespace
}  // namespace oraclegs
