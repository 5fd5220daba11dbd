#include "oraclegs/train/cuda/cuda_view_loss.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "oraclegs/train/view_loss.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs::cuda {
namespace {

Buffer<float> RandomPlane(uint64_t seed) { return RandomUniform({kHeight, kWidth}, seed); }

/// The image with values rounded as in a file of bytes.
Buffer<float> InBytes(const Buffer<float>& image) {
  return ToBuffer(image.shape(), (Flat(image).max(0.f).min(1.f) * 255).floor() / 255);
}

/// Photos with masks, depth and exposures of their own, proposals with confidence.
TrainingData Data() {
  TrainingData data(Photos(3), Photos(2));
  data.photos[1].pixel_weight = Above(RandomPlane(80), 0.3f);
  data.photos[1].exposure[0] = 1.3f;
  uint64_t seed = 81;
  for (TrainView* view : {&data.photos[0], &data.photos[1], &data.proposals[1]}) {
    view->inv_depth = RandomPlane(seed++);
    view->depth_mask = RandomPlane(seed++);
  }
  for (TrainView* view : {&data.photos[1], &data.photos[2]}) view->alpha = RandomPlane(seed++);
  data.proposals[0].pixel_weight = RandomPlane(seed++);
  return data;
}

RenderOutput RandomRender(int64_t number) {
  const auto seed = static_cast<uint64_t>(1000 + 3 * number);
  return {RandomUniform({kHeight, kWidth, 3}, seed), RandomPlane(seed + 1), RandomPlane(seed + 2)};
}

RenderOutput OnTestDevice(const RenderOutput& out) {
  return {OnTestDevice(out.image), OnTestDevice(out.alpha), OnTestDevice(out.inv_depth)};
}

CudaViewLoss LossOnTestDevice(const LossPlan& plan) {
  DeviceViews views(plan);
  views.MoveTo(TestDevice());
  return CudaViewLoss(plan, std::move(views), TestDevice());
}

double Total(const LossSums& sums) {
  DeviceArray<LossAccumulator> accumulator("a test");
  const LossAccumulator empty;
  accumulator.Upload(&empty, 1);
  RunAccumulateLoss({sums, 1, 0, accumulator.data()}, nullptr);
  return ToHost(accumulator, 1)[0].last;
}

class CudaViewLossTest : public CudaTest {
 protected:
  /// Expects the CPU's losses for photos and proposals in turn.
  void ExpectAsOnTheCpu(const TrainOptions& options, const TrainingData& data) {
    const LossPlan plan(options, data);
    ViewLoss expected(plan);
    CudaViewLoss loss = LossOnTestDevice(plan);
    int64_t number = 0;
    for (const SampledView view :
         {SampledView{ViewKind::kPhoto, 0}, SampledView{ViewKind::kProposal, 0}, SampledView{ViewKind::kPhoto, 1},
          SampledView{ViewKind::kProposal, 1}, SampledView{ViewKind::kPhoto, 2}, SampledView{ViewKind::kPhoto, 1}}) {
      const RenderOutput out = RandomRender(++number);
      const ViewLossResult wanted = expected(view, number, out);
      LossSums sums;
      const RenderGrads grads = loss(view, number, OnTestDevice(out), &sums);
      EXPECT_NEAR(Total(sums), wanted.loss, 1e-6) << number;
      EXPECT_LE(RelativeL2(OnHost(grads.image), wanted.grads.image), 1e-5) << number;
      for (Buffer<float> RenderGrads::*plane : {&RenderGrads::inv_depth, &RenderGrads::alpha}) {
        ASSERT_EQ((grads.*plane).defined(), (wanted.grads.*plane).defined()) << number;
        if (!(grads.*plane).defined()) continue;
        EXPECT_LE(RelativeL2(OnHost(grads.*plane), wanted.grads.*plane), 1e-6) << number;
      }
    }
    const ExposureState state = loss.exposures();
    ASSERT_EQ(state.maps.size(), expected.exposures() == nullptr ? 0u : 3u);
    for (size_t i = 0; i < state.maps.size(); ++i) {
      for (int k = 0; k < 12; ++k) EXPECT_NEAR(state.maps[i][k], expected.exposures()->maps()[i][k], 1e-5);
      EXPECT_EQ(state.steps[i], expected.exposures()->state().steps[i]);
    }
  }
};

TEST_F(CudaViewLossTest, IsTheCpus) { ExpectAsOnTheCpu(Options(), Data()); }

TEST_F(CudaViewLossTest, LearnsExposures) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  ExpectAsOnTheCpu(options, Data());
}

TEST_F(CudaViewLossTest, ANetworkAddsToTheProposals) {
  TrainingData data = Data();
  data.lpips = [](const Buffer<float>& render, const Buffer<float>& target, double weight, Buffer<float>* grad) {
    const Eigen::ArrayXd difference = Wide(OnHost(render)) - Wide(OnHost(target));
    const Buffer<float> sum = grad->CopyOn(kCpu);
    Flat(sum) += (weight * difference).cast<float>();
    grad->CopyFrom(sum);
    return difference.square().sum() / 2;
  };
  ExpectAsOnTheCpu(Options(), data);
}

TEST_F(CudaViewLossTest, ANetworkMeetsEachProposalAsOnePicture) {
  TrainingData data = Data();
  for (TrainView& view : data.proposals) view.image = InBytes(view.image);
  std::set<const void*> targets;
  data.lpips = [&](const Buffer<float>&, const Buffer<float>& target, double, Buffer<float>*) {
    targets.insert(target.data());
    return 0.;
  };
  const LossPlan plan(Options(), data);
  CudaViewLoss loss = LossOnTestDevice(plan);
  for (int64_t number = 1; number <= 6; ++number) {
    LossSums sums;
    loss({ViewKind::kProposal, static_cast<int>(number % 2)}, number, OnTestDevice(RandomRender(number)), &sums);
  }
  EXPECT_EQ(targets.size(), 2u);
}

TEST_F(CudaViewLossTest, PicturesOfBytesLieThereAsBytes) {
  TrainingData data(Photos(2));
  data.photos[0].image = InBytes(data.photos[0].image);
  const LossPlan plan(Options(), data);
  const DeviceViews views(plan);
  EXPECT_EQ(views.At({ViewKind::kPhoto, 0}).bytes(), 3 * kWidth * kHeight);
  EXPECT_EQ(views.At({ViewKind::kPhoto, 1}).bytes(), 12 * kWidth * kHeight);
  EXPECT_EQ(views.bytes(), 15 * kWidth * kHeight);
}

TEST_F(CudaViewLossTest, RefusesExposuresOfOtherPhotos) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  const LossPlan plan(options, Data());
  CudaViewLoss loss = LossOnTestDevice(plan);
  EXPECT_THROW(loss.RestoreExposures({{kIdentityExposure}, {kIdentityExposure}, {kIdentityExposure}, {0}}), InputError);
}

}  // namespace
}  // namespace oraclegs::cuda
