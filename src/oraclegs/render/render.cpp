#include "oraclegs/render/render.h"

#include "oraclegs/render/cpu/cpu_rasterizer.h"

namespace oraclegs {

std::unique_ptr<Rasterizer> MakeRasterizer(torch::Device device) {
  if (device.is_cpu()) return cpu::MakeCpuRasterizer();
  throw UsageError("this build renders on the CPU only, '{}' was asked for; use --device cpu", device.str());
}

}  // namespace oraclegs
