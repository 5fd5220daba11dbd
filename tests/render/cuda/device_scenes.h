#pragma once
// Scenes on the device under test, and their renders back on the CPU.

#include "oraclegs/render/cuda/cuda_rasterizer.h"
#include "render/scenes.h"
#include "support/cuda_device.h"
#include "support/tensors.h"

namespace oraclegs {

/// The emulated device's memory is the CPU's.
inline Device TestDevice() {
  return kEmulatedCuda ? Device(kCpu) : Device(torch::kCUDA, 0);
}

inline Buffer<float> OnTestDevice(const Buffer<float>& t) { return t.defined() ? t.to(TestDevice()) : t; }

inline Gaussians OnTestDevice(const Gaussians& g) {
  Gaussians out = g;
  out.ForEach([](const char*, Buffer<float>& t) { t = OnTestDevice(t); });
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
  Buffer<float> image, alpha, inv_depth;
  Gaussians grads;
  RenderStats stats;
};

inline RenderedTask RunTask(Rasterizer* rasterizer, const RenderTask& task, Device device) {
  Gaussians g = task.gaussians;
  g.ForEach([&](const char*, Buffer<float>& t) { t = t.To(device); });
  RenderOptions options = task.options;
  if (options.opacity_factors.defined()) options.opacity_factors = options.opacity_factors.To(device);
  const RenderOutput out = rasterizer->Forward(g, task.camera, options, RenderPass::kTrain);
  RenderedTask result{out.image.To(kCpu).Clone(),
                      out.alpha.To(kCpu).Clone(),
                      out.inv_depth.To(kCpu).Clone(),
                      Gaussians::Zeros(g.size()),
                      {}};
  result.grads.ForEach([&](const char*, Buffer<float>& t) { t = t.To(device); });
  const auto move = [&](const Buffer<float>& t) { return t.defined() ? t.To(device) : t; };
  rasterizer->Backward(g, {move(task.upstream.image), move(task.upstream.alpha), move(task.upstream.inv_depth)},
                       &result.grads);
  result.grads.ForEach([](const char*, Buffer<float>& t) { t = t.To(kCpu); });
  result.stats = rasterizer->stats();
  return result;
}

inline RenderGrads RandomUpstream(const Camera& camera, uint64_t seed) {
  torch::manual_seed(seed);
  return {torch::randn({camera.height, camera.width, 3}), torch::randn({camera.height, camera.width}),
          torch::randn({camera.height, camera.width})};
}

}  // namespace oraclegs
