#include "oraclegs/render/cuda/cuda_rasterizer.h"

#include "oraclegs/render/constants.h"
#include "oraclegs/render/cuda/gaussian_backward.h"
#include "oraclegs/render/cuda/raster_core.h"
#include "oraclegs/render/image_buffer.h"

namespace oraclegs::cuda {
namespace {

constexpr const char* kImages = "the rendered images";

View MakeView(const Camera& camera, const RenderOptions& options) {
  View view{};
  const Eigen::Matrix3d r = camera.cam_from_world.linear();
  const Eigen::Vector3d t = camera.cam_from_world.translation(), eye = camera.Center();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) view.r[3 * i + j] = static_cast<float>(r(i, j));
    view.t[i] = static_cast<float>(t[i]);
    view.eye[i] = static_cast<float>(eye[i]);
    view.background[i] = options.background[static_cast<size_t>(i)];
  }
  view.width = camera.width, view.height = camera.height;
  view.fx = static_cast<float>(camera.fx), view.fy = static_cast<float>(camera.fy);
  view.cx = static_cast<float>(camera.cx), view.cy = static_cast<float>(camera.cy);
  const double margin_u = kFrustumMargin * camera.width / (2 * camera.fx);
  const double margin_v = kFrustumMargin * camera.height / (2 * camera.fy);
  view.min_u = static_cast<float>(-camera.cx / camera.fx - margin_u);
  view.max_u = static_cast<float>((camera.width - camera.cx) / camera.fx + margin_u);
  view.min_v = static_cast<float>(-camera.cy / camera.fy - margin_v);
  view.max_v = static_cast<float>((camera.height - camera.cy) / camera.fy + margin_v);
  view.tiles_x = (camera.width + kTile - 1) / kTile;
  view.tiles_y = (camera.height + kTile - 1) / kTile;
  view.sh_degree = options.sh_degree;
  view.antialiased = options.antialiased;
  return view;
}

Parameters MakeParameters(const Gaussians& g) {
  const GaussianRows rows = g.Rows();
  return {rows.means, rows.log_scales, rows.quats, rows.opacity_logits, rows.sh, nullptr, g.size()};
}

/// The device's default stream; the device is the one that memory is taken from afterwards.
cudaStream_t StreamOf(Device device) {
  UseDevice(device.index);
  return nullptr;
}

class CudaRasterizer final : public Rasterizer {
 public:
  explicit CudaRasterizer(Device device)
      : device_(device),
        core_(StreamOf(device)),
        image_(device, kImages),
        alpha_(device, kImages),
        inv_depth_(device, kImages) {}

  RenderOutput Forward(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                       RenderPass pass) override {
    constexpr const char* kWho = "Rasterizer::Forward";
    gaussians.Check(kWho);
    gaussians.ForEach([&](const char* name, const Buffer<float>& t) { RequireHere(kWho, name, t); });
    if (camera.width < 1 || camera.height < 1 || camera.width > 32768 || camera.height > 32768) {
      throw ShapeError("{}: image is {} x {}, each side must be in 1 .. 32768", kWho, camera.width, camera.height);
    }
    if (options.sh_degree < 0 || options.sh_degree > kMaxShDegree) {
      throw ShapeError("{}: sh_degree is {}, must be in 0 .. {}", kWho, options.sh_degree, kMaxShDegree);
    }
    Parameters parameters = MakeParameters(gaussians);
    if (options.opacity_factors.defined()) {
      RequireShape(kWho, "opacity_factors", options.opacity_factors, {gaussians.size()});
      RequireHere(kWho, "opacity_factors", options.opacity_factors);
      parameters.opacity_factors = options.opacity_factors.data();
    }
    UseDevice(device_.index);
    trained_size_ = -1;  // until all is in place
    height_ = camera.height, width_ = camera.width;
    const RenderOutput out{image_.Get({height_, width_, 3}), alpha_.Get({height_, width_}),
                           inv_depth_.Get({height_, width_})};
    core_.Forward(MakeView(camera, options), parameters, {out.image.data(), out.alpha.data(), out.inv_depth.data()},
                  pass == RenderPass::kTrain);
    if (pass == RenderPass::kTrain) trained_size_ = gaussians.size();
    return out;
  }

  void Backward(const Gaussians& gaussians, const RenderGrads& upstream, Gaussians* grads) override {
    grads->Check("Rasterizer::Backward, grads");
    if (grads->size() != gaussians.size()) {
      throw ShapeError("Rasterizer::Backward: grads hold {} rows, expected {}", grads->size(), gaussians.size());
    }
    grads->ForEach(
        [&](const char* name, const Buffer<float>& t) { RequireHere("Rasterizer::Backward, grads", name, t); });
    WriteGaussianGrads(BlendBackward(gaussians, upstream), grads->Rows());
    core_.EndBackward();
  }

  void BackwardInto(const Gaussians& gaussians, const RenderGrads& upstream, GradientConsumer* consumer) override {
    consumer->ConsumeOnDevice(BlendBackward(gaussians, upstream));
    core_.EndBackward();
  }

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
  void RequireHere(const char* who, const char* name, const Buffer<float>& t) const {
    if (t.device() == device_) return;
    throw ShapeError("{}: {} is on {}, expected on {}", who, name, t.device().Name(), device_.Name());
  }

  const float* PlaneOrNull(const char* name, const Buffer<float>& t, std::initializer_list<int64_t> shape) const {
    if (!t.defined()) return nullptr;
    RequireShape("Rasterizer::Backward", name, t, shape);
    RequireHere("Rasterizer::Backward", name, t);
    return t.data();
  }

  /// The backward pass up to the gradients of Gaussians on the image plane.
  GaussianBackwardInput BlendBackward(const Gaussians& gaussians, const RenderGrads& upstream) {
    if (gaussians.size() != trained_size_) {
      throw ShapeError("Rasterizer::Backward: {} Gaussians, but the last Forward(kTrain) had {}", gaussians.size(),
                       trained_size_);
    }
    UseDevice(device_.index);
    return core_.BlendBackward(MakeParameters(gaussians),
                               {PlaneOrNull("upstream.image", upstream.image, {height_, width_, 3}),
                                PlaneOrNull("upstream.alpha", upstream.alpha, {height_, width_}),
                                PlaneOrNull("upstream.inv_depth", upstream.inv_depth, {height_, width_})});
  }

  Device device_;
  RasterCore core_;
  ImageBuffer image_, alpha_, inv_depth_;
  int64_t trained_size_ = -1, height_ = 0, width_ = 0;
};

}  // namespace

std::unique_ptr<Rasterizer> MakeCudaRasterizer(Device device) { return std::make_unique<CudaRasterizer>(device); }

}  // namespace oraclegs::cuda
