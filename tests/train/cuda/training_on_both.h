#pragma once
// The CPU's rasteriser as a device's: gradients of all Gaussians at once, on one thread.

#include "oraclegs/render/make_rasterizer.h"
#include "oraclegs/train/cuda/cuda_train_device.h"
#include "train/small_scene.h"

namespace oraclegs {

/// On a device of its own memory it copies to and fro.
class CopyingRasterizer final : public Rasterizer {
 public:
  explicit CopyingRasterizer(Device device) : device_(device) {}

  RenderOutput Forward(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                       RenderPass pass) override {
    RenderOptions on_host = options;
    if (options.opacity_factors.defined()) on_host.opacity_factors = options.opacity_factors.To(kCpu);
    const RenderOutput out = inner_->Forward(OnHost(gaussians), camera, on_host, pass);
    return {out.image.To(device_), out.alpha.To(device_), out.inv_depth.To(device_)};
  }
  void Backward(const Gaussians& gaussians, const RenderGrads& upstream, Gaussians* grads) override {
    Gaussians host = Gaussians::Zeros(gaussians.size());
    RenderGrads up = upstream;
    for (Buffer<float>* t : {&up.image, &up.alpha, &up.inv_depth}) {
      if (t->defined()) *t = t->to(kCpu);
    }
    inner_->Backward(OnHost(gaussians), up, &host);
    *grads = host;
    grads->ForEach([&](const char*, Buffer<float>& t) { t = t.To(device_); });
  }
  void BackwardBlocks(const Gaussians& gaussians, const RenderGrads& upstream, GradConsumer consume) override {
    Gaussians grads;
    Backward(gaussians, upstream, &grads);
    consume(0, gaussians.size(), grads.Rows());
  }
  RenderTimings timings() const override { return inner_->timings(); }
  RenderStats stats() const override { return inner_->stats(); }

 private:
  static Gaussians OnHost(const Gaussians& gaussians) {
    Gaussians host = gaussians;
    host.ForEach([](const char*, Buffer<float>& t) { t = t.To(kCpu); });
    return host;
  }

  Device device_;
  std::unique_ptr<Rasterizer> inner_ = MakeRasterizer(kCpu);
};

inline TrainDeviceMaker OnGpu(Device device) {
  return [device](const TrainDeviceSetup& setup) {
    return cuda::MakeCudaTrainDevice(device, setup, std::make_unique<CopyingRasterizer>(device));
  };
}

}  // namespace oraclegs
