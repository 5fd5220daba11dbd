#include "oraclegs/render/render.h"

#include "oraclegs/core/cuda_library.h"

namespace oraclegs {

void GradientConsumer::ConsumeBlock(int64_t, int64_t, const GaussianRows&) {
  throw ShapeError("this consumer of gradients does not work on a CPU");
}

void GradientConsumer::ConsumeOnDevice(const cuda::GaussianBackwardInput&) {
  throw ShapeError("this consumer of gradients does not work on a GPU");
}

std::unique_ptr<Rasterizer> MakeRasterizer(Device device) {
  if (device.is_cpu()) return cpu::MakeCpuRasterizer();
  return CudaFunction<decltype(cuda::MakeCudaRasterizer)>("MakeCudaRasterizer")(device, 0);
}

}  // namespace oraclegs
