#pragma once
// Scenes on the device under test, and their renders back on the CPU.

#include "oraclegs/render/cuda/stages.h"
#include "oraclegs/render/render.h"
#include "render/scenes.h"
#include "support/buffers.h"
#include "support/device_buffers.h"

namespace oraclegs {

inline Gaussians OnTestDevice(const Gaussians& g) {
  Gaussians out = g;
  out.ForEach([](const char*, Buffer<float>& t) { t = OnTestDevice(t); });
  return out;
}

inline RenderGrads OnTestDevice(const RenderGrads& g) {
  return {OnTestDevice(g.image), OnTestDevice(g.alpha), OnTestDevice(g.inv_depth)};
}

/// Writes the gradients.
class WritingConsumer final : public GradientConsumer {
 public:
  explicit WritingConsumer(Gaussians* grads) : grads_(grads) {}
  void ConsumeOnDevice(const cuda::GaussianBackwardInput& in) override {
    ++calls;
    cuda::WriteGaussianGrads(in, grads_->Rows());
  }
  int calls = 0;

 private:
  Gaussians* grads_;
};

/// A view of a scene, with the requested outputs.
struct RenderTask {
  Gaussians gaussians;
  Camera camera;
  RenderOptions options = {};
  RenderGrads upstream = {};
};

/// Copies of the results on the CPU.
struct RenderedTask {
  Buffer<float> image, alpha, inv_depth;
  Gaussians grads;
  RenderStats stats;
};

inline RenderedTask RunTask(Rasterizer* rasterizer, const RenderTask& task, Device device) {
  const Gaussians g = task.gaussians.To(device);
  RenderOptions options = task.options;
  options.opacity_factors = options.opacity_factors.To(device);
  const RenderOutput out = rasterizer->Forward(g, task.camera, options, RenderPass::kTrain);
  RenderedTask result{
      out.image.CopyOn(kCpu), out.alpha.CopyOn(kCpu), out.inv_depth.CopyOn(kCpu), Gaussians::Zeros(g.size()), {}};
  result.grads = result.grads.To(device);
  const RenderGrads& up = task.upstream;
  rasterizer->Backward(g, {up.image.To(device), up.alpha.To(device), up.inv_depth.To(device)}, &result.grads);
  result.grads = result.grads.To(kCpu);
  result.stats = rasterizer->stats();
  return result;
}

}  // namespace oraclegs
