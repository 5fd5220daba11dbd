// Exports that the program looks up in this library (core/cuda_library.h): the identity of this build, and the
// functions of the floors' device code.

#include <string_view>
#include <utility>

#include "oraclegs/core/cuda/memory.h"
#include "oraclegs/core/cuda_library.h"
#include "oraclegs/core/engine_source.h"
#include "oraclegs/depth/plane_search.h"
#include "oraclegs/gaussians/cuda/neighbors.h"
#include "oraclegs/propose/warp_device.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/train_device.h"

extern "C" const char* oraclegs_cuda_build();
extern "C" void* oraclegs_cuda_function(const char* name);

namespace oraclegs::cuda {
namespace {

template <class Function>
std::pair<std::string_view, void*> Entry(std::string_view name, Function* function) {
  return {name, reinterpret_cast<void*>(function)};
}

}  // namespace
}  // namespace oraclegs::cuda

const char* oraclegs_cuda_build() { return ORACLEGS_ENGINE_BUILD; }

void* oraclegs_cuda_function(const char* name) {
  namespace cuda = oraclegs::cuda;
  static const std::pair<std::string_view, void*> functions[] = {
      cuda::Entry("AllocateDevice", &cuda::AllocateDevice),
      cuda::Entry("Copy", &cuda::Copy),
      cuda::Entry("DeviceCount", &cuda::DeviceCount),
      cuda::Entry("FillWithZeros", &cuda::FillWithZeros),
      cuda::Entry("FreeDevice", &cuda::FreeDevice),
      cuda::Entry("MakeCudaPlaneSearch", &cuda::MakeCudaPlaneSearch),
      cuda::Entry("MakeCudaRasterizer", &cuda::MakeCudaRasterizer),
      cuda::Entry("MakeCudaTrainDevice", &cuda::MakeCudaTrainDevice),
      cuda::Entry("MakeCudaWarpDevice", &cuda::MakeCudaWarpDevice),
      cuda::Entry("MeanSquaredDistanceToThree", &cuda::MeanSquaredDistanceToThree),
      cuda::Entry("MemoryOfDevice", &cuda::MemoryOfDevice),
      cuda::Entry("RuntimeVersion", &cuda::RuntimeVersion),
      cuda::Entry("SetOutOfMemoryCallback", &cuda::SetOutOfMemoryCallback),
      cuda::Entry("UseDevice", &cuda::UseDevice),
  };
  for (const auto& [known, function] : functions) {
    if (known == name) return function;
  }
  return nullptr;
}
