#include "oraclegs/train/cuda/opacity_factors.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/train/opacity_factor_math-inl.h"

namespace oraclegs::cuda {
namespace {

constexpr int kFactorsBlock = 256;

__global__ void DrawFactors(OpacityFactorsInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kFactorsBlock + threadIdx.x;
  if (i >= in.count) return;
  const OpacityConstants constants{in.seed, static_cast<uint32_t>(in.iteration), static_cast<float>(in.drop),
                                   static_cast<float>(in.noise)};
  in.factors[i] = OpacityFactor<float>(constants, static_cast<uint32_t>(i));
}

}  // namespace

void RunOpacityFactors(const OpacityFactorsInput& in, cudaStream_t stream) {
  Launch("opacity factors", DrawFactors, LaunchShape::For(in.count, kFactorsBlock), stream, in);
}

}  // namespace oraclegs::cuda
