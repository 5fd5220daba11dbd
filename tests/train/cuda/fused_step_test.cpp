#include "oraclegs/train/cuda/fused_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/render/cuda/cuda_rasterizer.h"
#include "oraclegs/train/adam.h"
#include "support/buffers.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs::cuda {
namespace {

constexpr int64_t kCount = 300;

class CudaFusedStep : public CudaTest {};

TEST_F(CudaFusedStep, IsTheGradientsAndThenTheStep) {
  for (const int degree : {0, 1, 2, 3}) {
    const Gaussians start = RandomGaussians(kCount, 3);
    CudaRasterizer rasterizer(TestDevice());
    const Camera camera = CameraOnCircle(0.3);
    const RenderOptions render{{0.1f, 0.2f, 0.3f}, degree, false};
    torch::manual_seed(1);
    const RenderGrads upstream{OnTestDevice(torch::randn({kHeight, kWidth, 3}) / 1000), {}, {}};
    std::vector<Gaussians> results;
    for (const bool fused : {false, true}) {
      Gaussians gaussians = OnTestDevice(start);
      Adam adam(kCount);
      adam.m = OnTestDevice(adam.m);
      adam.v = OnTestDevice(adam.v);
      rasterizer.Forward(gaussians, camera, render, RenderPass::kTrain);
      StepConstants step;
      step.params = gaussians.Rows();
      step.adam = adam.BeginStep({1e-3}, degree, std::as_const(gaussians));
      step.m = adam.m.Rows();
      step.v = adam.v.Rows();
      step.regularizers = {1e-4f, 1e-4f};
      step.noise = {9, 1, 0.1f};
      step.adds_noise = true;
      if (fused) {
        RunFusedStep(rasterizer.BlendBackward(gaussians, upstream), step, nullptr);
        rasterizer.EndBackward();
      } else {
        rasterizer.BackwardBlocks(gaussians, upstream, [&](int64_t, int64_t end, const GaussianRows& grads) {
          RunStep(step, grads, end, nullptr);
        });
      }
      for (const Gaussians& rows : {gaussians, adam.m, adam.v}) results.push_back(OnHost(rows));
    }
    EXPECT_GT(MaxAbsError(results[0].means, start.means), 1e-4);
    for (int k = 0; k < 3; ++k) ExpectClose(results[3 + k], results[k], 1e-6);
  }
}

}  // namespace
}  // namespace oraclegs::cuda
