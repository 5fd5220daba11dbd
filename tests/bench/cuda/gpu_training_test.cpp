#include "bench/gpu_training.h"

#include "support/device_buffers.h"

namespace oraclegs {
namespace {

class GpuTrainingTest : public CudaTest {};

TEST_F(GpuTrainingTest, MeasuresWholeIterations) {
  GpuTraining training(SyntheticScene(200, 48, 32), TestDevice());
  const GpuTimes times = training.Measure(2);
  for (const double ms : {times.factors, times.project, times.bin, times.blend, times.loss, times.blend_backward,
                          times.forward, times.iteration, times.refine}) {
    EXPECT_GE(ms, 0);
  }
  EXPECT_GT(times.sending, 0);
  const GpuWork work = training.Work();
  EXPECT_EQ(work.gaussians, 200);
  EXPECT_EQ(work.pixels, 48 * 32);
  EXPECT_GT(work.visible, 50);
  EXPECT_GE(work.tile_pairs, work.visible);
  EXPECT_GT(work.pixel_pairs, 0);
  EXPECT_GT(work.pixel_pairs_backward, 0);
  EXPECT_GT(training.scratch_bytes(), 200 * 100);
}

TEST_F(GpuTrainingTest, LeavesTheStateAsItIs) {
  GpuTraining training(SyntheticScene(200, 48, 32), TestDevice(), ShMoments::kCompact);
  training.Measure(1);
  const GpuWork before = training.Work();
  training.Measure(2);
  const GpuWork after = training.Work();
  EXPECT_NEAR(after.tile_pairs, before.tile_pairs, 0.1 * before.tile_pairs);
}

TEST_F(GpuTrainingTest, MeasuresTheBandwidth) { EXPECT_GE(MeasureBandwidth(1 << 16), 0); }

}  // namespace
}  // namespace oraclegs
