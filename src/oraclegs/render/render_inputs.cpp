#include "oraclegs/render/render_inputs.h"

#include "oraclegs/render/constants.h"

namespace oraclegs {
namespace {

constexpr const char* kForward = "Rasterizer::Forward";
constexpr const char* kBackward = "Rasterizer::Backward";

void RequireDevice(const char* who, const char* name, const Buffer<float>& buffer, Device device) {
  if (buffer.device() == device) return;
  throw ShapeError("{}: {} is on {}, expected on {}", who, name, buffer.device().Name(), device.Name());
}

void CheckGaussians(const char* who, const Gaussians& gaussians, Device device) {
  gaussians.Check(who);
  gaussians.ForEach([&](const char* name, const Buffer<float>& buffer) { RequireDevice(who, name, buffer, device); });
}

GaussianParameters ParametersOf(const Gaussians& gaussians) {
  const GaussianRows rows = gaussians.Rows();
  return {rows.means, rows.log_scales, rows.quats, rows.opacity_logits, rows.sh, nullptr, gaussians.size()};
}

}  // namespace

GaussianParameters ForwardParameters(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                                     Device device) {
  CheckGaussians(kForward, gaussians, device);
  const auto fits = [](int side) { return side >= 1 && side <= kMaxRenderSide; };
  if (!fits(camera.width) || !fits(camera.height)) {
    throw ShapeError("{}: image is {} x {}, each side must be in 1 .. {}", kForward, camera.width, camera.height,
                     kMaxRenderSide);
  }
  if (options.sh_degree < 0 || options.sh_degree > kMaxShDegree) {
    throw ShapeError("{}: sh_degree is {}, must be in 0 .. {}", kForward, options.sh_degree, kMaxShDegree);
  }
  GaussianParameters parameters = ParametersOf(gaussians);
  if (options.opacity_factors.defined()) {
    RequireShape(kForward, "opacity_factors", options.opacity_factors, {gaussians.size()});
    RequireDevice(kForward, "opacity_factors", options.opacity_factors, device);
    parameters.opacity_factors = options.opacity_factors.data();
  }
  return parameters;
}

GaussianParameters BackwardParameters(const Gaussians& gaussians, int64_t trained) {
  if (gaussians.size() != trained) {
    throw ShapeError("{}: {} Gaussians, but the last Forward(kTrain) had {}", kBackward, gaussians.size(), trained);
  }
  return ParametersOf(gaussians);
}

UpstreamPlanes PlanesOf(const RenderGrads& upstream, int64_t height, int64_t width, Device device) {
  const auto plane = [&](const char* name, const Buffer<float>& buffer,
                         std::initializer_list<int64_t> shape) -> const float* {
    if (!buffer.defined()) return nullptr;
    RequireShape(kBackward, name, buffer, shape);
    RequireDevice(kBackward, name, buffer, device);
    return buffer.data();
  };
  return {plane("upstream.image", upstream.image, {height, width, 3}),
          plane("upstream.alpha", upstream.alpha, {height, width}),
          plane("upstream.inv_depth", upstream.inv_depth, {height, width})};
}

GaussianRows GradientRows(const Gaussians& grads, int64_t n, Device device) {
  CheckGaussians("Rasterizer::Backward, grads", grads, device);
  if (grads.size() != n) throw ShapeError("{}: grads hold {} rows, expected {}", kBackward, grads.size(), n);
  return grads.Rows();
}

void RequireWatched(const ScreenGradients& watched, int64_t n, Device device) {
  if (!watched.sum.defined()) return;
  for (const Buffer<float>* buffer : {&watched.sum, &watched.views}) {
    RequireShape(kBackward, "watched screen gradients", *buffer, {n});
    RequireDevice(kBackward, "watched screen gradients", *buffer, device);
  }
}

void RequireCameraGradient(bool summed) {
  if (!summed) throw ShapeError("Rasterizer::camera_gradient: the last backward pass did not watch the camera");
}

}  // namespace oraclegs
