#include "oraclegs/train/cuda/scale_cap.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs::cuda {
namespace {

constexpr int kBlock = 256;

__global__ void CapScales(ScaleCapInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x;
  if (i >= in.count) return;
  const float cap = LogScaleCap(in.params.means + 3 * i, in.centers, in.num_centers, in.log_share);
  for (int64_t k = 3 * i; k < 3 * i + 3; ++k) {
    if (in.params.log_scales[k] > cap) in.params.log_scales[k] = cap;
  }
}

}  // namespace

void RunCapScales(const ScaleCapInput& in, cudaStream_t stream) {
  if (in.num_centers == 0) return;
  Launch("the cap of scales", CapScales, LaunchShape::For(in.count, kBlock), stream, in);
}

}  // namespace oraclegs::cuda
