#include "oraclegs/train/cuda/opacity_factors.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs::cuda {
namespace {

constexpr int kFactorsBlock = 256;

__global__ void DrawFactors(OpacityFactorsInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kFactorsBlock + threadIdx.x;
  if (i >= in.count) return;
  const uint64_t counter = static_cast<uint64_t>(in.iteration) << 32 | static_cast<uint64_t>(i);
  in.factors[i] = OpacityFactor(in.seed, counter, static_cast<float>(in.drop), static_cast<float>(in.noise));
}

}  // namespace

void RunOpacityFactors(const OpacityFactorsInput& in, cudaStream_t stream) {
  Launch("opacity factors", DrawFactors, LaunchShape::For(in.count, kFactorsBlock), stream, in);
}

}  // namespace oraclegs::cuda
