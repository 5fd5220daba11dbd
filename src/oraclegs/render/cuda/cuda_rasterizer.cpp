#include "oraclegs/render/render.h"

#include "oraclegs/render/cuda/raster_core.h"
#include "oraclegs/render/cuda/stages.h"
#include "oraclegs/render/image_buffer.h"
#include "oraclegs/render/render_inputs.h"
#include "oraclegs/render/splat_camera.h"

namespace oraclegs::cuda {
namespace {

constexpr const char* kImages = "the rendered images";

/// The default stream of the device, which becomes the current one.
cudaStream_t StreamOf(Device device) {
  UseDevice(device.index);
  return nullptr;
}

class CudaRasterizer final : public Rasterizer {
 public:
  CudaRasterizer(Device device, int runs)
      : device_(device),
        core_(StreamOf(device), runs),
        image_(device, kImages),
        alpha_(device, kImages),
        inv_depth_(device, kImages) {}

  RenderOutput Forward(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                       RenderPass pass) override {
    const GaussianParameters parameters = ForwardParameters(gaussians, camera, options, device_);
    UseDevice(device_.index);
    trained_size_ = -1;  // until all is in place
    height_ = camera.height, width_ = camera.width;
    const RenderOutput out{image_.Get({height_, width_, 3}), alpha_.Get({height_, width_}),
                           inv_depth_.Get({height_, width_})};
    core_.Forward(MakeSplatCamera<float>(camera, options), parameters,
                  {out.image.data(), out.alpha.data(), out.inv_depth.data()}, pass == RenderPass::kTrain);
    if (pass == RenderPass::kTrain) trained_size_ = gaussians.size();
    return out;
  }

  void Backward(const Gaussians& gaussians, const RenderGrads& upstream, Gaussians* grads) override {
    const GaussianRows rows = GradientRows(*grads, gaussians.size(), device_);
    WriteGaussianGrads(BlendBackward(gaussians, upstream), rows);
    core_.EndBackward();
  }

  void BackwardInto(const Gaussians& gaussians, const RenderGrads& upstream, GradientConsumer* consumer) override {
    consumer->ConsumeOnDevice(BlendBackward(gaussians, upstream));
    core_.EndBackward();
  }

  void WatchScreen(const ScreenGradients* watched) override {
    watched_ = watched == nullptr ? ScreenGradients() : *watched;
  }

  void WatchCamera(bool watched) override { core_.WatchCamera(watched); }
  CameraGradient camera_gradient() const override { return core_.camera_gradient(); }

  void ReserveGaussians(int64_t n) override { core_.ReserveGaussians(n); }

  RenderTimings timings() const override {
    const StageTimes t = core_.times();
    return {t.project, t.bin, t.blend, t.blend_backward, t.gaussian_backward};
  }

  RenderStats stats() const override {
    const Counters c = core_.counters();
    return {static_cast<int64_t>(c.visible), static_cast<int64_t>(c.pairs), static_cast<int64_t>(c.pixel_pairs),
            static_cast<int64_t>(c.pixel_pairs_backward), core_.bytes()};
  }

 private:
  /// The backward pass up to the gradients of Gaussians on the image plane.
  GaussianBackwardInput BlendBackward(const Gaussians& gaussians, const RenderGrads& upstream) {
    const GaussianParameters parameters = BackwardParameters(gaussians, trained_size_);
    const UpstreamPlanes planes = PlanesOf(upstream, height_, width_, device_);
    RequireWatched(watched_, gaussians.size(), device_);
    UseDevice(device_.index);
    GaussianBackwardInput in = core_.BlendBackward(parameters, planes);
    in.screen_sums = watched_.sum.data(), in.screen_views = watched_.views.data();
    return in;
  }

  Device device_;
  RasterCore core_;
  ImageBuffer image_, alpha_, inv_depth_;
  ScreenGradients watched_;  // undefined = none
  int64_t trained_size_ = -1, height_ = 0, width_ = 0;
};

}  // namespace

std::unique_ptr<Rasterizer> MakeCudaRasterizer(Device device, int runs) {
  return std::make_unique<CudaRasterizer>(device, runs);
}

int64_t EstimateRasterizerBytes(int64_t gaussians, int64_t pairs, int64_t pixels) {
  constexpr int64_t kImageBytes = 5 * sizeof(float);  // of a pixel: rgb, alpha and inverse depth
  return RasterCore::EstimateBytes(gaussians, pairs, pixels) + kImageBytes * pixels;
}

}  // namespace oraclegs::cuda
