#pragma once
// Checks that every rasterizer makes of its inputs, and the inputs as its kernels take them. All throw ShapeError.

#include "oraclegs/render/render.h"
#include "oraclegs/render/splats.h"

namespace oraclegs {

/// The parameters for Rasterizer::Forward. Throws unless all buffers fit and lie on `device`, the image has sides of 1
/// to kMaxRenderSide pixels and the degree is 0 to 3.
GaussianParameters ForwardParameters(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                                     Device device);

/// The parameters for the backward pass, without opacity factors. Throws unless there are as many Gaussians as the last
/// Forward(kTrain) had; `trained` is -1 when there was none.
GaussianParameters BackwardParameters(const Gaussians& gaussians, int64_t trained);

/// Throws unless the planes that are given fit an image of this size and lie on `device`.
UpstreamPlanes PlanesOf(const RenderGrads& upstream, int64_t height, int64_t width, Device device);

/// Throws unless `grads` has a row for each of n Gaussians, on `device`.
GaussianRows GradientRows(const Gaussians& grads, int64_t n, Device device);

/// Throws unless the screen gradients are undefined or those of n Gaussians, on `device`.
void RequireWatched(const ScreenGradients& watched, int64_t n, Device device);

/// Throws unless the last backward pass summed the camera's gradient.
void RequireCameraGradient(bool summed);

}  // namespace oraclegs
