#pragma once
// A camera as the kernels of every device read it.

#include <cstdint>

namespace oraclegs {

struct Camera;
struct CameraGradient;
struct RenderOptions;

/// A pinhole camera and how to render with it. F: float or double.
template <class F>
struct SplatCamera {
  F r[9];                        ///< world-to-camera rotation, row-major
  F t[3];                        ///< translation
  F eye[3];                      ///< center, -R' t
  F fx, fy, cx, cy;              ///< pixels
  F min_u, max_u, min_v, max_v;  ///< clamp of the linearization point (docs/method.md#projection)
  F background[3];
  int width, height, tiles_x, tiles_y;
  int sh_degree;
  bool antialiased;

  int64_t tiles() const { return int64_t{tiles_x} * tiles_y; }
};

/// Rounded to F from double precision.
template <class F>
SplatCamera<F> MakeSplatCamera(const Camera& camera, const RenderOptions& options);

/// Numbers whose sums over the Gaussians give the gradient of the camera (docs/method.md#camera-gradient):
/// [0..2] dL/d(mean), world axes  [3..5] dL/d(rotation)  [6..9] dL/d(fx, fy, cx, cy)
inline constexpr int kCameraSums = 10;

CameraGradient CameraGradientOf(const SplatCamera<float>& camera, const double* sums);

}  // namespace oraclegs
