// Densifiers and parts of published methods, on a CPU and on a GPU.

#include <gtest/gtest.h>

#include <functional>

#include "baselines/baseline_trainer.h"
#include "oraclegs/train/train_device.h"
#include "train/cuda/device_gaussians.h"

namespace oraclegs {
namespace {

/// Depth of the true scene from anywhere, on the host as every source's.
PseudoDepth DepthOfTruth() {
  return [](const Camera& camera, const Buffer<float>& image, const CompareDepth& compare) {
    const RenderOutput out = MakeRasterizer(kCpu)->Forward(Truth(), camera, {}, RenderPass::kInference);
    compare({out.inv_depth.Clone(), {}});
    return Buffer<float>::Zeros(image.shape());
  };
}

/// Adaptive density control on photos of known depth, so that clones, splits, removals and resets happen before
/// iteration 60.
BaselineSetup AdaptiveSetup() {
  TrainOptions options = Options(100);
  options.opacity_reg = options.scale_reg = options.largest_scale = options.depth_weight = 0;
  options.max_gaussians = 300;
  options.dropout = 0.1;
  std::vector<TrainView> photos = Photos(3);
  const auto rasterizer = MakeRasterizer(kCpu);
  for (TrainView& photo : photos) {
    const RenderOutput out = rasterizer->Forward(Truth(), photo.camera, {}, RenderPass::kInference);
    photo.inv_depth = out.inv_depth.Clone();
    photo.depth_mask = Above(out.alpha, 0.3f);
  }
  BaselineSetup setup = SmallSetup(options, std::move(photos));
  setup.baseline.adaptive = true;
  setup.baseline.opacity_reset = 45;
  setup.pseudo_depth = DepthOfTruth();
  return setup;
}

std::unique_ptr<TrainDevice> OnTheGpu(const TrainDeviceSetup& setup) {
  return cuda::MakeCudaTrainDevice(TestDevice(), setup);
}

Trainer TrainerOn(BaselineSetup setup, const TrainDeviceMaker& make_device) {
  setup.make_device = make_device;
  return BaselineTrainer(std::move(setup));
}

/// Expects that both devices train alike, and that a GPU goes on from its own checkpoint to the same bits.
void ExpectBothTrain(const std::function<void(BaselineSettings*)>& change) {
  BaselineSetup setup = AdaptiveSetup();
  change(&setup.baseline);
  Trainer cpu = TrainerOn(setup, OnTheCpu), gpu = TrainerOn(setup, OnTheGpu);
  for (int i = 1; i <= 48; ++i) {
    const double wanted = cpu.Step();
    EXPECT_NEAR(gpu.Step(), wanted, 5e-3 * wanted) << i;
    if (i == 10) ExpectClose(OnHost(gpu.gaussians()), cpu.gaussians(), 1e-2);
  }
  EXPECT_NE(cpu.gaussians().size(), 60);
  EXPECT_NEAR(gpu.gaussians().size(), cpu.gaussians().size(), 2) << "a gradient may lie at the threshold";

  Trainer resumed = TrainerOn(setup, OnTheGpu);
  resumed.Restore(gpu.MakeCheckpoint());
  for (int i = 0; i < 12; ++i) EXPECT_EQ(resumed.Step(), gpu.Step()) << i;
  EXPECT_TRUE(SameBits(OnHost(resumed.gaussians()), OnHost(gpu.gaussians())));
}

class MethodsOnGpuTest : public CudaTest {};

TEST_F(MethodsOnGpuTest, AdaptiveDensity) {
  ExpectBothTrain([](BaselineSettings*) {});
}

TEST_F(MethodsOnGpuTest, UnpoolingAndSplitsOfTheIsolated) {
  ExpectBothTrain([](BaselineSettings* settings) {
    settings->proximity_split = true;
    settings->unpool_until = 2000;
  });
}

TEST_F(MethodsOnGpuTest, CorrelatedDepth) {
  ExpectBothTrain([](BaselineSettings* settings) {
    settings->depth_correlation = 0.05;
    settings->patched_correlation = 0.15;
  });
}

TEST_F(MethodsOnGpuTest, PseudoDepths) {
  ExpectBothTrain([](BaselineSettings* settings) {
    settings->pseudo_depth_weight = 0.5;
    settings->pseudo_depth_start = 1;
    settings->pseudo_depth_every = 2;
  });
}

TEST_F(MethodsOnGpuTest, DepthSteps) {
  ExpectBothTrain([](BaselineSettings* settings) {
    settings->hard_depth = true;
    settings->soft_depth_start = 5;
    settings->depth_step_every = 4;
  });
}

TEST_F(MethodsOnGpuTest, TwoFieldsBeforeRandomBackgrounds) {
  ExpectBothTrain([](BaselineSettings* settings) {
    settings->two_fields = settings->random_background = true;
    settings->co_start = 15;  // once the models differ by more than rounding
  });
}

TEST_F(MethodsOnGpuTest, PruneModes) {
  ExpectBothTrain([](BaselineSettings* settings) { settings->prune_modes_at = 20; });
}

}  // namespace
}  // namespace oraclegs
