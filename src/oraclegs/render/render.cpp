#include "oraclegs/render/render.h"

#include "oraclegs/core/config.h"

namespace oraclegs {

void GradientConsumer::ConsumeBlock(int64_t, int64_t, const GaussianRows&) {
  throw ShapeError("this consumer of gradients does not work on a CPU");
}

void GradientConsumer::ConsumeOnDevice(const cuda::GaussianBackwardInput&) {
  throw ShapeError("this consumer of gradients does not work on a GPU");
}

std::unique_ptr<Rasterizer> MakeRasterizer(Device device) {
  if (device.is_cpu()) return cpu::MakeCpuRasterizer();
#if defined(ORACLEGS_CUDA)
  if (device.is_cuda()) return cuda::MakeCudaRasterizer(device);
#endif
  throw UsageError("this build has no rasterizer for '{}'; use --device cpu", device.Name());
}

}  // namespace oraclegs
