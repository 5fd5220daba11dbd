#pragma once
// Scenes on the device under test, and their renders back on the CPU.

#include "oraclegs/render/cuda/cuda_rasterizer.h"
#include "render/scenes.h"
#include "support/cuda_device.h"
#include "support/tensors.h"

namespace oraclegs {

/// The emulated device's memory is the CPU's.
inline torch::Device TestDevice() {
  return kEmulatedCuda ? torch::Device(torch::kCPU) : torch::Device(torch::kCUDA, 0);
}

inline Tensor OnTestDevice(const Tensor& t) { return t.defined() ? t.to(TestDevice()).contiguous() : t; }

inline Gaussians OnTestDevice(const Gaussians& g) {
  Gaussians out = g;
  out.ForEach([](const char*, Tensor& t) { t = OnTestDevice(t); });
  return out;
}

inline RenderGrads OnTestDevice(const RenderGrads& g) {
  return {OnTestDevice(g.image), OnTestDevice(g.alpha), OnTestDevice(g.inv_depth)};
}

/// A view of a scene, and what is asked of it.
struct RenderTask {
  Gaussians gaussians;
  Camera camera;
  RenderOptions options = {};
  RenderGrads upstream = {};
};

/// Copies on the CPU.
struct RenderedTask {
  Tensor image, alpha, inv_depth;
  Gaussians grads;
  RenderStats stats;
};

inline RenderedTask RunTask(Rasterizer* rasterizer, const RenderTask& task, torch::Device device) {
  Gaussians g = task.gaussians;
  g.ForEach([&](const char*, Tensor& t) { t = t.to(device).contiguous(); });
  RenderOptions options = task.options;
  if (options.opacity_factors.defined()) options.opacity_factors = options.opacity_factors.to(device);
  const RenderOutput out = rasterizer->Forward(g, task.camera, options, RenderPass::kTrain);
  RenderedTask result{out.image.to(torch::kCPU).clone(),
                      out.alpha.to(torch::kCPU).clone(),
                      out.inv_depth.to(torch::kCPU).clone(),
                      Gaussians::Zeros(g.size()),
                      {}};
  result.grads.ForEach([&](const char*, Tensor& t) { t = t.to(device); });
  const auto move = [&](const Tensor& t) { return t.defined() ? t.to(device) : t; };
  rasterizer->Backward(g, {move(task.upstream.image), move(task.upstream.alpha), move(task.upstream.inv_depth)},
                       &result.grads);
  result.grads.ForEach([](const char*, Tensor& t) { t = t.to(torch::kCPU); });
  result.stats = rasterizer->stats();
  return result;
}

inline RenderGrads RandomUpstream(const Camera& camera, uint64_t seed) {
  torch::manual_seed(seed);
  return {torch::randn({camera.height, camera.width, 3}), torch::randn({camera.height, camera.width}),
          torch::randn({camera.height, camera.width})};
}

}  // namespace oraclegs
