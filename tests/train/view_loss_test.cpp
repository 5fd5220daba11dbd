#include "oraclegs/train/view_loss.h"

#include <cmath>

#include "oraclegs/loss/depth_losses.h"
#include "oraclegs/train/schedule.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

constexpr SampledView kFirstPhoto{ViewKind::kPhoto, 0}, kFirstProposal{ViewKind::kProposal, 0};

/// A view of noise, with confidence and depth.
TrainView Noise(const std::string& name, uint64_t seed) {
  TrainView view{name, CameraOnCircle(0.2), RandomUniform({kHeight, kWidth, 3}, 10 * seed),
                 RandomUniform({kHeight, kWidth}, 10 * seed + 1)};
  view.inv_depth = RandomUniform({kHeight, kWidth}, 10 * seed + 2);
  view.depth_mask = RandomUniform({kHeight, kWidth}, 10 * seed + 3);
  return view;
}

RenderOutput Render() {
  return {RandomUniform({kHeight, kWidth, 3}, 119), RandomUniform({kHeight, kWidth}, 120),
          RandomUniform({kHeight, kWidth}, 121)};
}

/// A plan and the loss by it.
struct Planned {
  Planned(const TrainOptions& options, TrainingData data) : plan(options, std::move(data)), loss(plan) {}
  ViewLossResult operator()(const SampledView& view, int64_t iteration, const RenderOutput& out) {
    return loss(view, iteration, out);
  }

  LossPlan plan;
  ViewLoss loss;
};

TEST(ViewLoss, WeighsProposalsByConfidenceAndDepthByItsMask) {
  TrainOptions options = Options();
  options.depth_weight = 2;
  const TrainView photo = Photos(1)[0], proposal = Noise("proposal", 3);
  const RenderOutput out = Render();
  Planned loss(options, {{photo}, {proposal}});
  const ViewLossResult result = loss(kFirstProposal, 30, out);

  Buffer<float> grad = Buffer<float>::Empty(out.image.shape()),
                grad_depth = Buffer<float>::Empty(out.inv_depth.shape());
  const double image = PhotometricLoss()(out.image, proposal.image, proposal.pixel_weight, {0.7f, 0.3f}, &grad).loss;
  const double weight = 2 * CharacteristicDepth({proposal}) * DepthWeight(30, options.iterations);
  const double depth = MaskedL1(out.inv_depth, proposal.inv_depth, proposal.depth_mask, weight, &grad_depth);
  EXPECT_GT(depth, 0);
  EXPECT_DOUBLE_EQ(result.loss, image + depth);
  EXPECT_TRUE(Equal(result.grads.image, grad));
  EXPECT_TRUE(Equal(result.grads.inv_depth, grad_depth));
  EXPECT_FALSE(result.grads.alpha.defined());
}

TEST(ViewLoss, WeighsAlphaByTheMask) {
  TrainOptions options = Options();
  options.alpha_weight = 0.4;
  TrainView photo = Photos(1)[0];
  photo.pixel_weight = Above(RandomUniform({kHeight, kWidth}, 122), 0.3f);
  const RenderOutput out = Render();
  const double without = Planned(options, {{photo}})(kFirstPhoto, 1, out).loss;
  photo.alpha = RandomUniform({kHeight, kWidth}, 123);
  Planned loss(options, {{photo}});
  const ViewLossResult result = loss(kFirstPhoto, 1, out);
  Buffer<float> grad = Buffer<float>::Empty(out.alpha.shape());
  const double alpha = MaskedL1(out.alpha, photo.alpha, photo.pixel_weight, 0.4, &grad);
  EXPECT_GT(alpha, 0);
  EXPECT_DOUBLE_EQ(result.loss, without + alpha);
  EXPECT_TRUE(Equal(result.grads.alpha, grad));
  options.alpha_weight = 0;
  Planned off(options, {{photo}});
  EXPECT_FALSE(off(kFirstPhoto, 1, out).grads.alpha.defined());
}

TEST(ViewLoss, TakesTheDepthScaleFromPhotos) {
  TrainView photo = Noise("photo", 2), proposal = Noise("proposal", 3);
  Flat(photo.inv_depth).setConstant(0.125);
  Flat(proposal.inv_depth).setConstant(0.5);
  const RenderOutput out = Render();
  const auto depth_part = [&](const TrainingData& data) {
    TrainOptions options = Options();
    const double with = Planned(options, data)(kFirstProposal, 1, out).loss;
    options.depth_weight = 0;
    return with - Planned(options, data)(kFirstProposal, 1, out).loss;
  };
  const double far = depth_part({{photo}, {proposal}}), near = depth_part({{Photos(1)[0]}, {proposal}});
  EXPECT_NEAR(far, 4 * near, 1e-6 * far);
}

TEST(ViewLoss, WeighsPixelsByThePowerOfTheirConfidence) {
  TrainOptions options = Options();
  options.confidence_power = 2;
  TrainView proposal = Noise("proposal", 3);
  const RenderOutput out = Render();
  Planned loss(options, {{Photos(1)[0]}, {proposal}});
  const ViewLossResult result = loss(kFirstProposal, 1, out);
  Buffer<float> grad = Buffer<float>::Empty(out.image.shape());
  const Buffer<float> weights = ToBuffer(proposal.pixel_weight.shape(), Flat(proposal.pixel_weight).square());
  PhotometricLoss()(out.image, proposal.image, weights, {0.7f, 0.3f}, &grad);
  EXPECT_LE(MaxAbsError(result.grads.image, grad), 1e-9);
  EXPECT_TRUE(Equal(loss.plan.View(kFirstProposal).image, proposal.image));
}

TEST(ViewLoss, SeesProposalsThroughNoExposureMap) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  auto photos = Photos(2);
  photos[0].exposure = {1.5f, 0, 0, 0, 0, 1.5f, 0, 0, 0, 0, 1.5f, 0};
  const TrainView proposal = Noise("proposal", 3);
  const RenderOutput out = Render();
  Planned exposed(options, {photos, {proposal}});
  options.exposure = ExposureMode::kOff;
  Planned plain(options, {photos, {proposal}});
  ASSERT_NE(exposed.loss.exposures(), nullptr);
  EXPECT_EQ(plain.loss.exposures(), nullptr);
  const std::vector<ExposureMap> before = exposed.loss.exposures()->maps();
  EXPECT_EQ(exposed(kFirstProposal, 1, out).loss, plain(kFirstProposal, 1, out).loss);
  EXPECT_EQ(exposed.loss.exposures()->maps(), before);
  EXPECT_NE(exposed(kFirstPhoto, 1, out).loss, plain(kFirstPhoto, 1, out).loss);
  EXPECT_NE(exposed.loss.exposures()->maps(), before);
}

TEST(ViewLoss, WeighsLpipsByTheMeanConfidence) {
  const TrainView proposal = Noise("proposal", 3);
  const RenderOutput out = Render();
  TrainOptions options = Options();
  options.depth_weight = 0;
  const Eigen::ArrayXd difference = Wide(out.image) - Wide(proposal.image);
  const double scale = 2 / static_cast<double>(difference.size());
  // A stand-in that is easy to differentiate: mean (render - target)^2.
  const PerceptualDistance mean_square = [&](auto&&, auto&&, double weight, Buffer<float>* grad) {
    Flat(*grad) += (weight * scale * difference).cast<float>();
    return difference.square().mean();
  };
  Planned loss(options, {Photos(1), {proposal}, mean_square});
  const ViewLossResult result = loss(kFirstProposal, 1, out);
  Buffer<float> grad = Buffer<float>::Empty(out.image.shape());
  const double image = PhotometricLoss()(out.image, proposal.image, proposal.pixel_weight, {0.4f, 0.3f}, &grad).loss;
  const double weight = 0.3 * MeanConfidence(proposal);
  EXPECT_DOUBLE_EQ(result.loss, image + weight * difference.square().mean());
  EXPECT_LE(RelativeL2(result.grads.image, Wide(grad) + weight * scale * difference), 1e-6);
}

TEST(ViewLoss, DoesNotAskTheNetworkAboutProposalsWithoutConfidence) {
  TrainView proposal = Photos(1)[0];
  proposal.pixel_weight = Buffer<float>::Zeros({kHeight, kWidth});
  bool asked = false;
  const PerceptualDistance network = [&](auto&&...) {
    asked = true;
    return 1.;
  };
  Planned loss(Options(), {Photos(1), {proposal}, network});
  const ViewLossResult result = loss(kFirstProposal, 1, Render());
  EXPECT_EQ(result.loss, 0);
  EXPECT_EQ(MaxAbs(result.grads.image), 0);
  EXPECT_FALSE(asked);
}

TEST(ViewLoss, NamesIterationAndViewOfALossThatIsNotFinite) {
  TrainView proposal = Noise("proposal7", 3);
  proposal.image[(3 * kWidth + 4) * 3] = std::nanf("");
  Planned loss(Options(), {Photos(1), {proposal}});
  EXPECT_THAT(MessageOf<RunError>([&] { loss(kFirstProposal, 12, Render()); }),
              testing::HasSubstr("iteration 12 on proposal7"));
}

TEST(ViewLoss, IsThatOfFloatsForBytes) {
  TrainView bytes = Noise("proposal", 3), floats = bytes;
  bytes.image = bytes.pixel_weight = {};
  bytes.image_bytes = Buffer<uint8_t>::Empty({kHeight, kWidth, 3});
  bytes.weight_bytes = Buffer<uint8_t>::Empty({kHeight, kWidth});
  for (int64_t i = 0; i < bytes.image_bytes.count(); ++i) bytes.image_bytes[i] = static_cast<uint8_t>(37 * i % 256);
  for (int64_t i = 0; i < bytes.weight_bytes.count(); ++i) bytes.weight_bytes[i] = static_cast<uint8_t>(11 * i % 256);
  floats.image = bytes.Image(), floats.pixel_weight = bytes.Weights();
  EXPECT_EQ(floats.image[2], 74.f / 255);
  Planned expected(Options(), {Photos(1), {floats}}), loss(Options(), {Photos(1), {bytes}});
  const ViewLossResult wanted = expected(kFirstProposal, 1, Render()), result = loss(kFirstProposal, 1, Render());
  EXPECT_EQ(result.loss, wanted.loss);
  EXPECT_TRUE(Equal(result.grads.image, wanted.grads.image));
}

}  // namespace
}  // namespace oraclegs
