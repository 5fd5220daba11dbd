#include "oraclegs/stages/perceptual.h"

#include "oraclegs/networks/loader.h"
#include "run/fixtures.h"
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
  void SetUp() override {
    SKIP_WITHOUT_NETWORKS();
    file = WriteTinyLpips(temp / "lpips.safetensors");
    plan.lpips = {file};
  }
  static std::vector<TrainView> Proposals(int side) {
    TrainView view;
    view.name = "a", view.camera.width = side, view.camera.height = side + 2;
    return {view};
  }

  TempDir temp;
  std::filesystem::path file;
  Plan plan;
  TrainOptions options;
  const Buffer<float> render = RandomUniform({30, 40, 3}, 11), target = RandomUniform({30, 40, 3}, 12);
  EventRecorder recorder;
};

TEST_F(PerceptualTest, LossIsTheNetworksAndAddsItsGradient) {
  const auto network = GetNetworks().LoadPerceptual({file}, kCpu, 0);
  Buffer<float> expected = Buffer<float>::Zeros(render.shape());
  const double value = network->Loss(render, target, 1, &expected);
  EXPECT_GT(value, 0);
  const PerceptualDistance loss = LpipsOfProposals(options, plan, Proposals(40), Silent()).distance;
  Buffer<float> grad = Buffer<float>::Full(render.shape(), 1), none;
  EXPECT_EQ(loss(render, target, 0.25, &grad), value);
  EXPECT_LT(MaxAbsError(grad, 1 + 0.25 * Wide(expected)), 1e-7) << "adds to what is there";
  EXPECT_EQ(loss(render, target, 1, nullptr), value);
  EXPECT_EQ(loss(render, target, 1, &none), value);
}

TEST_F(PerceptualTest, ProposalsUseItWhereThereAreWeightsAndAShare) {
  const TrainingLpips lpips = LpipsOfProposals(options, plan, Proposals(40), recorder.AsListener());
  EXPECT_TRUE(lpips.distance);
  EXPECT_EQ(lpips.convention, "VGG16, images in [0, 1]");
  EXPECT_FALSE(LpipsOfProposals(options, plan, {}, Silent()).distance);
  TrainOptions without = options;
  without.proposal_lpips = 0;
  EXPECT_FALSE(LpipsOfProposals(without, plan, Proposals(40), Silent()).distance);
  without = options, without.schedule = ScheduleKind::kNone;
  EXPECT_FALSE(LpipsOfProposals(without, plan, Proposals(40), Silent()).distance);
  EXPECT_FALSE(LpipsOfProposals(options, {}, Proposals(40), recorder.AsListener()).distance) << "no weights";
  EXPECT_TRUE(recorder.warnings.empty());
}

TEST_F(PerceptualTest, ProposalsThatAreTooSmallDoWithoutIt) {
  EXPECT_TRUE(LpipsOfProposals(options, plan, Proposals(16), recorder.AsListener()).distance);
  EXPECT_TRUE(recorder.warnings.empty());
  EXPECT_FALSE(LpipsOfProposals(options, plan, Proposals(8), recorder.AsListener()).distance);
  ASSERT_EQ(recorder.warnings.size(), 1u);
  EXPECT_THAT(recorder.warnings[0], HasSubstr("proposals of 8 pixels a side are too small for LPIPS, which needs 16"));
}

TEST_F(PerceptualTest, ScoresAreOfBothConventionsAndSaySo) {
  const ImageScores scores = LpipsScores({file}, kCpu, Silent());
  const auto network = GetNetworks().LoadPerceptual({file}, kCpu, 0);
  const std::map<std::string, double> values = scores.of(render, target);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values.at("lpips"), network->Score(render, target, LpipsRange::kZeroOne));
  EXPECT_EQ(values.at("lpips_minus1_1"), network->Score(render, target, LpipsRange::kMinusOneOne));
  EXPECT_NE(values.at("lpips"), values.at("lpips_minus1_1"));
  EXPECT_THAT(scores.conventions.at("lpips"), HasSubstr("VGG16, images in [0, 1]"));
  EXPECT_THAT(scores.conventions.at("lpips_minus1_1"), HasSubstr("[-1, 1]"));
  EXPECT_EQ(scores.smallest_side, 16);
  EXPECT_FALSE(LpipsScores({}, kCpu, Silent()).of);
  const auto alex = WriteTinyAlexNetLpips(temp / "alex.safetensors");
  EXPECT_THAT(LpipsScores({alex}, kCpu, Silent()).conventions.at("lpips"), HasSubstr("AlexNet"));
}

}  // namespace
}  // namespace oraclegs
