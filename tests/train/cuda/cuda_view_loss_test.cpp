#include "oraclegs/train/cuda/cuda_view_loss.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "oraclegs/train/cpu_train_device.h"
#include "support/buffers.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs::cuda {
namespace {

/// Photographs with masks, depth and exposures of their own, proposals with confidence.
TrainingData Data() {
  torch::manual_seed(8);
  TrainingData data(Photographs(3), Photographs(2));
  data.photographs[1].confidence = (torch::rand({kHeight, kWidth}) > 0.3).to(torch::kFloat);
  data.photographs[1].exposure[0] = 1.3f;
  for (TrainView* view : {&data.photographs[0], &data.photographs[1], &data.proposals[1]}) {
    view->inv_depth = torch::rand({kHeight, kWidth});
    view->depth_mask = torch::rand({kHeight, kWidth});
  }
  for (TrainView* view : {&data.photographs[1], &data.photographs[2]}) view->alpha = torch::rand({kHeight, kWidth});
  data.proposals[0].confidence = torch::rand({kHeight, kWidth});
  return data;
}

RenderOutput RandomRender() {
  return {torch::rand({kHeight, kWidth, 3}), torch::rand({kHeight, kWidth}), torch::rand({kHeight, kWidth})};
}

double Total(const LossTerms& terms) {
  DeviceArray<LossAccumulator> ledger("a test");
  const LossAccumulator empty;
  ledger.Upload(&empty, 1);
  RunLedger({terms, 1, 0, ledger.data()}, nullptr);
  return ToHost(ledger, 1)[0].last;
}

class CudaViewLossTest : public CudaTest {
 protected:
  /// Every view once, learning from photographs.
  void ExpectAsOnTheCpu(const TrainOptions& options, const TrainingData& data) {
    ViewLoss expected(options, data), source(options, data);
    DeviceViews views(source);
    views.MoveTo(TestDevice());
    CudaViewLoss loss(source, std::move(views), TestDevice());
    int64_t number = 0;
    for (const SampledView view : {SampledView{ViewKind::kPhotograph, 0}, SampledView{ViewKind::kProposal, 0},
                                   SampledView{ViewKind::kPhotograph, 1}, SampledView{ViewKind::kProposal, 1},
                                   SampledView{ViewKind::kPhotograph, 2}, SampledView{ViewKind::kPhotograph, 1}}) {
      Iteration iteration;
      iteration.number = ++number;
      iteration.view = view;
      const RenderOutput out = RandomRender();
      const ViewLossResult wanted = expected(view, number, out);
      LossTerms terms;
      const RenderGrads grads =
          loss(iteration, {OnTestDevice(out.image), OnTestDevice(out.alpha), OnTestDevice(out.inv_depth)}, &terms);
      EXPECT_NEAR(Total(terms), wanted.loss, 1e-6) << number;
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

TEST_F(CudaViewLossTest, IsTheCpus) { ExpectAsOnTheCpu(Options().Settled(), Data()); }

TEST_F(CudaViewLossTest, LearnsExposures) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  ExpectAsOnTheCpu(options.Settled(), Data());
}

TEST_F(CudaViewLossTest, ANetworkAddsToTheProposals) {
  TrainingData data = Data();
  data.lpips = [](const Buffer<float>& render, const Buffer<float>& target, double weight, Buffer<float>* grad) {
    grad->add_(weight * (render - target));
    return (render - target).square().sum().item<double>() / 2;
  };
  ExpectAsOnTheCpu(Options().Settled(), data);
}

TEST_F(CudaViewLossTest, ANetworkMeetsEachProposalAsOnePicture) {
  TrainingData data = Data();
  for (TrainView& view : data.proposals)
    view.image = (view.image.clamp(0, 1) * 255).to(torch::kByte).to(torch::kFloat) / 255;
  std::set<const void*> targets;
  data.lpips = [&](const Buffer<float>&, const Buffer<float>& target, double, Buffer<float>*) {
    targets.insert(target.data_ptr());
    return 0.;
  };
  const ViewLoss source(Options().Settled(), data);
  DeviceViews views(source);
  views.MoveTo(TestDevice());
  CudaViewLoss loss(source, std::move(views), TestDevice());
  for (int64_t number = 1; number <= 6; ++number) {
    Iteration iteration;
    iteration.number = number;
    iteration.view = {ViewKind::kProposal, static_cast<int>(number % 2)};
    const RenderOutput out = RandomRender();
    LossTerms terms;
    loss(iteration, {OnTestDevice(out.image), OnTestDevice(out.alpha), OnTestDevice(out.inv_depth)}, &terms);
  }
  EXPECT_EQ(targets.size(), 2u);
}

TEST_F(CudaViewLossTest, PicturesOfBytesLieThereAsBytes) {
  TrainingData data(Photographs(2));
  data.photographs[0].image = (data.photographs[0].image.clamp(0, 1) * 255).to(torch::kByte).to(torch::kFloat) / 255;
  const ViewLoss source(Options().Settled(), data);
  const DeviceViews views(source);
  EXPECT_EQ(views.At({ViewKind::kPhotograph, 0}, false).bytes(), 3 * kWidth * kHeight);
  EXPECT_EQ(views.At({ViewKind::kPhotograph, 1}, false).bytes(), 12 * kWidth * kHeight);
  EXPECT_EQ(views.bytes(), 15 * kWidth * kHeight);
}

TEST_F(CudaViewLossTest, RefusesExposuresOfOtherPhotographs) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  const ViewLoss source(options.Settled(), Data());
  CudaViewLoss loss(source, DeviceViews(source), TestDevice());
  EXPECT_THROW(loss.RestoreExposures({{kIdentityExposure}, {kIdentityExposure}, {kIdentityExposure}, {0}}), InputError);
}

}  // namespace
}  // namespace oraclegs::cuda
