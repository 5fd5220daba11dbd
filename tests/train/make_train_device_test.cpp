#include "oraclegs/train/train_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/cuda_library.h"
#include "support/errors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

class CpuTrainDeviceTest : public testing::Test {
 protected:
  TrainOptions options = Options();
  LossPlan plan{options, Photos(1)};
  std::unique_ptr<TrainDevice> device = MakeCpuTrainDevice({options, plan, 60});
};

TEST_F(CpuTrainDeviceTest, CopiesShareNoMemory) {
  const Gaussians start = Start();
  const TrainedModel model = device->Upload({start});
  EXPECT_TRUE(SameBits(model.gaussians, start));
  EXPECT_NE(model.gaussians.means.data(), start.means.data());
  EXPECT_EQ(model.adam.m.size(), start.size());
  EXPECT_EQ(MaxAbs(model.adam.v.means), 0);
  EXPECT_EQ(model.adam.sh_moments(), options.sh_moments);
  const TrainedModel copy = device->Download(model);
  EXPECT_NE(copy.adam.m.means.data(), model.adam.m.means.data());
}

TEST_F(CpuTrainDeviceTest, SmoothsTheLossFromTheRestoredOne) {
  TrainedModel model = device->Upload({Start()});
  device->RestoreLoss(10);
  Iteration iteration;
  iteration.number = 5;
  const RenderOutput out =
      device->rasterizer().Forward(model.gaussians, plan.photos()[0].camera, {}, RenderPass::kTrain);
  device->BackwardAndStep(iteration, device->LossOfView(iteration, out), &model);
  const LossReport loss = device->Loss();
  EXPECT_GT(loss.last, 0);
  EXPECT_DOUBLE_EQ(loss.smoothed, kLossSmoothing * 10 + (1 - kLossSmoothing) * loss.last);
  const TermSums terms = device->Terms();
  EXPECT_EQ(terms.photos, 1);
  EXPECT_EQ(terms.proposals, 0);
  EXPECT_NEAR((1 - options.ssim_weight) * terms.l1 + options.ssim_weight * terms.dssim + terms.depth + terms.alpha +
                  terms.regularization,
              loss.last, 1e-6);
  EXPECT_EQ(terms.Since(terms).l1, 0);
}

TEST_F(CpuTrainDeviceTest, HasNoExposuresWithoutTrainingThem) {
  EXPECT_TRUE(device->exposures().maps.empty());
  EXPECT_NO_THROW(device->RestoreExposures({}));
}

TEST(MakeTrainDevice, MakesTheCpus) {
  const TrainOptions options = Options();
  const LossPlan plan(options, Photos(1));
  EXPECT_NE(MakeTrainDevice(kCpu, {options, plan, 60}), nullptr);
}

TEST(MakeTrainDevice, NeedsTheLibraryOfDeviceCodeForAGpu) {
  if (HasCudaLibrary()) GTEST_SKIP() << "which this build has";
  const TrainOptions options = Options();
  const LossPlan plan(options, Photos(1));
  const Device gpu{DeviceKind::kCuda, 0};
  EXPECT_THAT(MessageOf<UsageError>([&] {
                MakeTrainDevice(gpu, {options, plan, 60});
              }),
              testing::HasSubstr("liboraclegs_cuda.so, which is not here"));
}

}  // namespace

}  // namespace oraclegs
