#include "oraclegs/render/cuda/stages.h"

#include "oraclegs/core/cuda/sums-inl.cuh"
#include "oraclegs/render/cuda/gaussian_backward-inl.cuh"

namespace oraclegs::cuda {
namespace {

/// Consumer that stores the gradients as rows.
struct WriteRows {
  GaussianRows rows;
  int floats;  // of sh that are written

  __device__ void ConsumeSmall(int64_t i, const GaussianGrad& grad) const {
    for (int k = 0; k < 3; ++k) {
      rows.means[3 * i + k] = grad.mean[k];
      rows.log_scales[3 * i + k] = grad.log_scale[k];
    }
    for (int k = 0; k < 4; ++k) rows.quats[4 * i + k] = grad.quat[k];
    rows.opacity_logits[i] = grad.logit;
  }
  __device__ void ConsumeSh(int64_t i, int first, float4 grad) const {
    float* to = rows.sh + kShRow * i + first;
    if (first + 4 <= floats) {
      *reinterpret_cast<float4*>(to) = grad;
      return;
    }
    const float values[4] = {grad.x, grad.y, grad.z, grad.w};
    for (int k = 0; first + k < floats; ++k) to[k] = values[k];
  }
};

/// One block per sum.
__global__ void AddRows(const float* of_warps, int64_t warps, CameraSums* sums) {
  __shared__ double shared[kSumWarps];
  const int thread = static_cast<int>(threadIdx.x), number = static_cast<int>(blockIdx.x);
  double sum = 0;
  for (int64_t warp = thread; warp < warps; warp += kSumThreads) sum += of_warps[number * warps + warp];
  sum = BlockSum(sum, thread, shared);
  if (thread == 0) sums->of[number] = sum;
}

}  // namespace

void AddCameraSums(const float* of_warps, int64_t warps, CameraSums* sums, cudaStream_t stream) {
  Launch("the gradient of the camera", AddRows, LaunchShape{kCameraSums, kSumThreads}, stream, of_warps, warps, sums);
}

void WriteGaussianGrads(const GaussianBackwardInput& in, const GaussianRows& grads) {
  const int floats = 3 * (in.camera.sh_degree + 1) * (in.camera.sh_degree + 1);
  RunGaussianBackward("gradients of Gaussians", in, WriteRows{grads, floats});
}

}  // namespace oraclegs::cuda
