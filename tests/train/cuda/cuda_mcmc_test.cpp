#include "oraclegs/train/cuda/cuda_mcmc.h"

#include <gtest/gtest.h>

#include "oraclegs/render/render.h"
#include "oraclegs/train/cuda/device_views.h"
#include "oraclegs/train/mcmc.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs::cuda {
namespace {

class CudaMcmcTest : public CudaTest {};

TEST_F(CudaMcmcTest, MovesTheDeadAndGrowsAsTheCpuDoes) {
  const TrainOptions options = Options();
  const LossPlan plan(options, Photos(2));
  DeviceViews views(plan);
  views.MoveTo(TestDevice());
  const auto on_cpu = MakeRasterizer(kCpu), on_gpu = MakeCudaRasterizer(TestDevice());
  const auto cpu = MakeMcmcDensifier({options, plan, on_cpu.get()});
  const auto gpu = MakeCudaMcmcDensifier({options, plan, on_gpu.get(), TestDevice()}, views, 80);
  Iteration iteration;
  iteration.seed = kSeed, iteration.number = 40, iteration.refines = true;
  iteration.rates.means = 1e-4;
  TrainedModel host{Start(), Adam(Start().size())}, device = host;
  device.gaussians = device.gaussians.To(TestDevice());
  device.adam.ForEachMoment([](const char*, const char*, auto& buffer) { buffer = buffer.To(TestDevice()); });
  cpu->Refine(iteration, &host);
  gpu->Refine(iteration, &device);
  EXPECT_EQ(host.gaussians.size(), 63);
  EXPECT_TRUE(gpu->AddsNoise());
  ExpectClose(OnHost(device.gaussians), host.gaussians, 1e-4);
}

}  // namespace
}  // namespace oraclegs::cuda
