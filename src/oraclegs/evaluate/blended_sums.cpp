#include "oraclegs/evaluate/blended_sums.h"

#include "oraclegs/core/error.h"

namespace oraclegs {

BlendedSums::BlendedSums(const Gaussians& gaussians, const RenderOptions& options)
    : rasterizer_(MakeRasterizer(gaussians.device())),
      gray_(gaussians),
      grads_(Gaussians::Zeros(gaussians.size(), gaussians.device())),
      options_(options) {
  gray_.sh = Buffer<float>::Zeros(gaussians.sh.shape(), gaussians.device());
  options_.sh_degree = 0;
}

void BlendedSums::Take(const Camera& camera, const Buffer<float>& numbers) {
  RequireShape("BlendedSums", "numbers", numbers, {camera.height, camera.width, 3});
  rasterizer_->Forward(gray_, camera, options_, RenderPass::kTrain);
  RenderGrads grads;
  grads.image = numbers.To(gray_.device());
  rasterizer_->Backward(gray_, grads, &grads_);
  sh_ = grads_.sh.To(kCpu);
}

double BlendedSums::Of(int64_t i, int k) const { return static_cast<double>(sh_[i * kShFloats + k]) / kConstantSh; }

}  // namespace oraclegs
