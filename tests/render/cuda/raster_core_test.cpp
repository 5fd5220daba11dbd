// The rasterizer on a device: the same bits however much memory there was, and no allocation in a steady iteration.

#include "oraclegs/render/cuda/raster_core.h"

#include "render/cuda/device_scenes.h"
#if defined(ORACLEGS_EMULATED_CUDA)
#include "support/emulated_cuda/runtime.h"
#endif

namespace oraclegs {
namespace {

class RasterCoreTest : public CudaTest {
 protected:
  static RenderTask Task(int64_t gaussians, int width, int height) {
    RenderTask task{RandomGaussians(gaussians, 0.15, 4), FrontCamera(width, height)};
    task.upstream = RandomUpstream(task.camera, 3);
    return task;
  }
  static void ExpectSameBits(const RenderedTask& a, const RenderedTask& b) {
    EXPECT_TRUE(Equal(a.image, b.image));
    EXPECT_TRUE(Equal(a.inv_depth, b.inv_depth));
    EXPECT_TRUE(Equal(a.grads.means, b.grads.means));
    EXPECT_TRUE(Equal(a.grads.quats, b.grads.quats));
    EXPECT_TRUE(Equal(a.grads.sh, b.grads.sh));
    EXPECT_EQ(a.stats.pixel_pairs, b.stats.pixel_pairs);
    EXPECT_EQ(a.stats.pixel_pairs_backward, b.stats.pixel_pairs_backward);
  }
};

TEST_F(RasterCoreTest, KeepsBitsWhenMemoryGrows) {
  const RenderTask few = Task(20, 30, 20), many = Task(700, 60, 40);
  const auto fresh = cuda::MakeCudaRasterizer(TestDevice()), grown = cuda::MakeCudaRasterizer(TestDevice());
  const RenderedTask expected = RunTask(fresh.get(), many, TestDevice());
  RunTask(grown.get(), few, TestDevice());
  const int64_t before = grown->stats().device_bytes;
  ExpectSameBits(RunTask(grown.get(), many, TestDevice()), expected);
  EXPECT_GT(grown->stats().device_bytes, before);
  ExpectSameBits(RunTask(grown.get(), many, TestDevice()), expected);  // now there is room
  RunTask(grown.get(), few, TestDevice());
  ExpectSameBits(RunTask(grown.get(), many, TestDevice()), expected);  // and what was there before does not matter
}

TEST_F(RasterCoreTest, KeepsBitsAfterManySmallViews) {
  const RenderTask few = Task(5, 20, 16), many = Task(300, 60, 40);
  const auto fresh = cuda::MakeCudaRasterizer(TestDevice()), rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const RenderedTask expected = RunTask(fresh.get(), many, TestDevice());
  ExpectSameBits(RunTask(rasterizer.get(), many, TestDevice()), expected);
  const int64_t room = rasterizer->stats().device_bytes;
  for (int view = 0; view < 100; ++view) RunTask(rasterizer.get(), few, TestDevice());
  ExpectSameBits(RunTask(rasterizer.get(), many, TestDevice()), expected);
  EXPECT_EQ(rasterizer->stats().device_bytes, room);  // what is sent shrinks, and not what is held
}

TEST_F(RasterCoreTest, BucketsOfSeveralRunsGiveTheSameGradients) {
  RenderTask task{RandomGaussians(2000, 0.15, 4), FrontCamera(60, 40)};
  task.upstream = RandomUpstream(task.camera, 3);
  task.options.background = {0.3f, 0.5f, 0.7f};
  const RenderedTask expected = RunTask(cuda::MakeCudaRasterizer(TestDevice(), 1).get(), task, TestDevice());
  ASSERT_GT(expected.stats.tile_pairs, 2 * 128 * 12);  // 12 tiles of several buckets, also of the longest
  for (const int runs : {2, 4}) {
    const RenderedTask out = RunTask(cuda::MakeCudaRasterizer(TestDevice(), runs).get(), task, TestDevice());
    EXPECT_TRUE(Equal(out.image, expected.image));
    std::vector<Buffer<float>> wanted;
    expected.grads.ForEach([&](const char*, const Buffer<float>& grad) { wanted.push_back(grad); });
    size_t next = 0;
    out.grads.ForEach([&](const char* name, const Buffer<float>& grad) {
      const Buffer<float>& other = wanted[next++];
      EXPECT_LE(MaxAbsError(grad, other), 1e-5 * static_cast<double>(MaxAbs(other))) << name << ", " << runs;
    });
  }
}

TEST_F(RasterCoreTest, TheBackwardPassCanBeRepeated) {
  for (const int runs : {1, 4}) {
    const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice(), runs);
    const RenderTask task = Task(700, 60, 40);
    const RenderedTask first = RunTask(rasterizer.get(), task, TestDevice());
    const Gaussians g = task.gaussians.To(TestDevice());
    Gaussians again = Gaussians::Zeros(g.size()).To(TestDevice());
    const RenderGrads up{OnTestDevice(task.upstream.image), OnTestDevice(task.upstream.alpha),
                         OnTestDevice(task.upstream.inv_depth)};
    GradientConsumer of_the_cpu;  // takes no gradients of a device
    EXPECT_THROW(rasterizer->BackwardInto(g, up, &of_the_cpu), ShapeError);
    rasterizer->Backward(g, up, &again);
    again = again.To(kCpu);
    EXPECT_TRUE(Equal(again.means, first.grads.means));
    EXPECT_TRUE(Equal(again.sh, first.grads.sh));
  }
}

TEST_F(RasterCoreTest, EstimatesItsMemory) {
  for (const int runs : {0, 4}) {
    const RenderTask task = Task(2000, 200, 150);
    const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice(), runs);
    const RenderStats stats = RunTask(rasterizer.get(), task, TestDevice()).stats;
    const int64_t held = stats.device_bytes, pixels = int64_t{200} * 150;
    const int64_t estimate = cuda::EstimateRasterizerBytes(2000, stats.tile_pairs, pixels);
    if (runs == 0) {
      // A GPU sorts in less memory than the emulated one.
      EXPECT_NEAR(static_cast<double>(estimate), static_cast<double>(held), 0.4 * static_cast<double>(held));
    } else {
      EXPECT_LT(held, estimate / 2);  // which is of the runs that so few Gaussians have
    }
  }
}

TEST_F(RasterCoreTest, CountsAndTimes) {
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  EXPECT_EQ(rasterizer->stats().tile_pairs, 0);
  EXPECT_EQ(rasterizer->timings().blend, 0);
  const RenderedTask out = RunTask(rasterizer.get(), Task(100, 40, 30), TestDevice());
  EXPECT_GT(out.stats.visible, 0);
  EXPECT_GE(out.stats.tile_pairs, out.stats.visible);
  EXPECT_GT(out.stats.pixel_pairs, 0);
  EXPECT_GT(out.stats.pixel_pairs_backward, 0);
  EXPECT_GE(rasterizer->timings().blend_backward, 0);
}

TEST_F(RasterCoreTest, RefusesTooManyPairs) {
  EXPECT_NO_THROW(cuda::RequireCountable(1000, 1 << 29));
  EXPECT_THROW(cuda::RequireCountable(1000, int64_t{1} << 31), RunError);
}

TEST_F(RasterCoreTest, NeedsForwardBeforeBackward) {
  cuda::RasterCore core(nullptr);
  EXPECT_THROW(core.BlendBackward({}, {}), ShapeError);
}

#if defined(ORACLEGS_EMULATED_CUDA)
TEST_F(RasterCoreTest, AllocatesNothingInASteadyIteration) {
  const RenderTask task = Task(150, 40, 30);
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  Gaussians grads = Gaussians::Zeros(150);
  const auto iterate = [&] {
    rasterizer->Forward(task.gaussians, task.camera, {}, RenderPass::kTrain);
    rasterizer->Backward(task.gaussians, task.upstream, &grads);
  };
  iterate();
  const emulated_cuda::Counts before = emulated_cuda::CountCalls();
  iterate();
  const emulated_cuda::Counts after = emulated_cuda::CountCalls();
  EXPECT_EQ(after.allocations, before.allocations);
  EXPECT_EQ(after.waits, before.waits + 2);  // for counts, each with work still queued behind it
}

TEST_F(RasterCoreTest, SurvivesOutOfMemory) {
  const RenderTask task = Task(200, 40, 30);
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  emulated_cuda::SetMemory(100000);
  EXPECT_THROW(RunTask(rasterizer.get(), task, TestDevice()), RunError);
  emulated_cuda::SetMemory(size_t{1} << 40);
  const auto other = cuda::MakeCudaRasterizer(TestDevice());
  ExpectSameBits(RunTask(rasterizer.get(), task, TestDevice()), RunTask(other.get(), task, TestDevice()));
}
#endif

}  // namespace
}  // namespace oraclegs
