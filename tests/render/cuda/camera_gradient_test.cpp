// The camera's gradient on a device, against the CPU's and against differences in double precision.

#include <string>

#include "render/camera_numbers.h"
#include "render/cuda/device_scenes.h"
#include "render/reference_raster.h"

namespace oraclegs {
namespace {

class CudaCameraGradient : public CudaTest {
 protected:
  static RenderTask Task(const PosedScene& scene, const RenderOptions& options) {
    return {scene.gaussians, scene.camera, options, RandomUpstream(scene.camera, 3)};
  }
  static CameraNumbers Watch(Rasterizer* rasterizer, const RenderTask& task, Device device) {
    rasterizer->WatchCamera(true);
    RunTask(rasterizer, task, device);
    return NumbersOf(rasterizer->camera_gradient());
  }
  static CameraNumbers OnDevice(const RenderTask& task) {
    return Watch(cuda::MakeCudaRasterizer(TestDevice()).get(), task, TestDevice());
  }
};

TEST_F(CudaCameraGradient, AgreesWithTheCpu) {
  struct Case {
    std::string name;
    int64_t gaussians;
    double scale;
    int degree = 3;
    bool antialiased = false;
  };
  for (const Case& c : {Case{"small", 500, 0.02}, Case{"needles", 300, 0.2}, Case{"huge", 45, 3}, Case{"few", 5, 0.5},
                        Case{"none", 0, 0.1}, Case{"degree 0", 150, 0.1, 0}, Case{"degree 1", 150, 0.1, 1},
                        Case{"degree 2", 150, 0.1, 2}, Case{"antialiased", 300, 0.02, 3, true}}) {
    const RenderTask task =
        Task(PosedScene(c.gaussians, c.scale, {60, 45}), {{0.3f, 0.1f, 0.6f}, c.degree, c.antialiased});
    const CameraNumbers gpu = OnDevice(task), cpu = Watch(MakeRasterizer(kCpu).get(), task, kCpu);
    constexpr size_t kGroups[] = {0, 3, 6, 8, 10};
    for (int group = 0; group < 4; ++group) {
      double scale = 0;
      for (size_t k = kGroups[group]; k < kGroups[group + 1]; ++k) scale = std::max(scale, std::abs(cpu[k]));
      EXPECT_EQ(scale > 0, c.gaussians > 0) << c.name;
      for (size_t k = kGroups[group]; k < kGroups[group + 1]; ++k) {
        EXPECT_NEAR(gpu[k], cpu[k], 1e-3 * scale) << c.name << ", number " << k;
      }
    }
  }
}

TEST_F(CudaCameraGradient, MatchesCentralDifferences) {
  for (const bool antialiased : {false, true}) {
    const RenderTask task = Task(PosedScene(25, 0.25, {24, 20}), {{0.1f, 0.5f, 0.9f}, 3, antialiased});
    ReferenceScene reference(task.gaussians, task.camera, task.options);
    const auto loss = [&](const Camera& camera) {
      reference.camera = camera;
      return reference.Loss(task.upstream);
    };
    ExpectCameraDifferences(task.camera, loss, OnDevice(task));
  }
}

TEST_F(CudaCameraGradient, HasTheSameBitsEachTimeAndChangesNoOther) {
  const RenderTask task = Task(PosedScene(700, 0.1, {60, 45}), {});
  const auto rasterizer = cuda::MakeCudaRasterizer(TestDevice());
  const RenderedTask unwatched = RunTask(rasterizer.get(), task, TestDevice());
  EXPECT_THROW(rasterizer->camera_gradient(), ShapeError);
  const CameraNumbers first = Watch(rasterizer.get(), task, TestDevice());
  EXPECT_EQ(OnDevice(task), first);

  const Gaussians g = OnTestDevice(task.gaussians);
  Gaussians grads = OnTestDevice(Gaussians::Zeros(700));
  WritingConsumer consumer(&grads);
  rasterizer->Forward(g, task.camera, task.options, RenderPass::kTrain);
  rasterizer->BackwardInto(g, OnTestDevice(task.upstream), &consumer);
  rasterizer->Forward(g, FrontCamera(20, 20), task.options, RenderPass::kInference);  // the next view
  EXPECT_EQ(NumbersOf(rasterizer->camera_gradient()), first);
  EXPECT_TRUE(Equal(OnHost(grads.means), unwatched.grads.means));
  EXPECT_TRUE(Equal(OnHost(grads.quats), unwatched.grads.quats));
  EXPECT_TRUE(Equal(OnHost(grads.sh), unwatched.grads.sh));

  rasterizer->WatchCamera(false);
  RunTask(rasterizer.get(), task, TestDevice());
  EXPECT_THROW(rasterizer->camera_gradient(), ShapeError);
}

}  // namespace
}  // namespace oraclegs
