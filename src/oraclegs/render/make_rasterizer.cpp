#include "oraclegs/render/make_rasterizer.h"

#include "oraclegs/core/config.h"
#include "oraclegs/render/cpu/cpu_rasterizer.h"
#if defined(ORACLEGS_CUDA)
#include "oraclegs/render/cuda/cuda_rasterizer.h"
#endif

namespace oraclegs {

std::unique_ptr<Rasterizer> MakeRasterizer(Device device) {
  if (device.is_cpu()) return cpu::MakeCpuRasterizer();
#if defined(ORACLEGS_CUDA)
  if (device.is_cuda()) return cuda::MakeCudaRasterizer(device);
#endif
  throw UsageError("this build has no rasterizer for '{}'; use --device cpu", device.Name());
}

}  // namespace oraclegs
