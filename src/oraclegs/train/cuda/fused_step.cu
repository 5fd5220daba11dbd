#include "oraclegs/train/cuda/fused_step.h"

#include "oraclegs/render/cuda/gaussian_backward-inl.cuh"
#include "oraclegs/train/cuda/step-inl.cuh"

namespace oraclegs::cuda {
namespace {

struct TakeStep {
  StepConstants step;

  __device__ void ConsumeSmall(int64_t i, const GaussianGrad& grad) const {
    SplatRow g;
    for (int k = 0; k < 3; ++k) g.mean[k] = grad.mean[k], g.log_scale[k] = grad.log_scale[k];
    for (int k = 0; k < 4; ++k) g.quat[k] = grad.quat[k];
    g.logit = grad.logit;
    MoveSplat(step, i, g);
  }
  __device__ void ConsumeSh(int64_t i, int first, float4 grad) const {
    MoveColor(step, i, first, {{grad.x, grad.y, grad.z, grad.w}});
  }
};

}  // namespace

void RunFusedStep(const GaussianBackwardInput& in, const StepConstants& step, cudaStream_t stream) {
  RunGaussianBackward("gradients of Gaussians and Adam", in, TakeStep{step}, stream);
}

}  // namespace oraclegs::cuda
