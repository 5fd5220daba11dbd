// The search for a photo's pose with a rasterizer of a device.

#include "oraclegs/train/camera_steps.h"

#include "oraclegs/camera/similarity.h"
#include "render/cuda/device_scenes.h"

namespace oraclegs {
namespace {

class CudaAlignCamera : public CudaTest {};

TEST_F(CudaAlignCamera, GoesWhereTheCpuGoes) {
  const Gaussians scene = RandomGaussians(60, 0.15, 5);
  TrainView view{"photo", FrontCamera(40, 30), {}, {}};
  view.image = MakeRasterizer(kCpu)->Forward(scene, view.camera, {}, RenderPass::kInference).image.Clone();
  view.camera.cam_from_world = Nudged(view.camera.cam_from_world, {0.003, -0.004, 0.002}, {0.01, 0, 0.02});
  const CameraAlignOptions options{4, 5e-4};
  const AlignedCamera cpu = AlignCamera(MakeRasterizer(kCpu).get(), scene, view, {}, options);
  TrainView on_device = view;
  on_device.image = OnTestDevice(view.image);
  const AlignedCamera gpu =
      AlignCamera(cuda::MakeCudaRasterizer(TestDevice()).get(), OnTestDevice(scene), on_device, {}, options);
  EXPECT_LT(gpu.loss, gpu.loss_before);
  EXPECT_NEAR(gpu.loss, cpu.loss, 1e-3 * cpu.loss);
  EXPECT_NEAR((gpu.camera.cam_from_world.matrix() - cpu.camera.cam_from_world.matrix()).norm(), 0, 1e-5);
}

}  // namespace
}  // namespace oraclegs
