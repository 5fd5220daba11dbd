#pragma once
// The one rasterizer interface. Semantics: docs/method.md#projection to #color-gradient. MakeRasterizer
// makes that of a device.

#include <array>
#include <memory>

#include "oraclegs/camera/camera.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

namespace cuda {
struct GaussianBackwardInput;  // render/cuda/splats.h
}

struct RenderOptions {
  std::array<float, 3> background{0, 0, 0};  ///< RGB, [0, 1]
  int sh_degree = kMaxShDegree;              ///< active degree, 0..3; higher coefficients are neither read nor written
  bool antialiased = false;                  ///< docs/method.md#antialiasing; a model is rendered as it was trained
  /// [N] float32, finite and >= 0, undefined = 1: multiplies each Gaussian's opacity for this render. 0 leaves the
  /// Gaussian out, without gradient. The product may exceed 1, alpha is capped as always. Gradients are those of the
  /// raw parameters; the factors get none. Read by Forward only.
  Buffer<float> opacity_factors = {};
};

enum class RenderPass {
  kInference,  ///< nothing is kept
  kTrain,      ///< buffers for Backward are kept until the next Forward
};

/// Images of one camera. Valid until the rasterizer's next Forward: buffers are reused. Do not write them before
/// Backward, which may read them.
struct RenderOutput {
  Buffer<float> image;      ///< [H,W,3] composited on the background, not clamped
  Buffer<float> alpha;      ///< [H,W] 1 - transmittance
  Buffer<float> inv_depth;  ///< [H,W] sum of weight / z, not divided by alpha, 1/world unit
};

/// dL/d(output). An undefined buffer means zero.
struct RenderGrads {
  Buffer<float> image;      ///< [H,W,3]
  Buffer<float> alpha;      ///< [H,W]
  Buffer<float> inv_depth;  ///< [H,W]
};

/// Blocks of gradients begin at multiples of this many Gaussians. Parameters, moments and gradients of a block are 60
/// KB and stay in the nearest caches.
inline constexpr int64_t kGradBlock = 64;

/// Consumer of a backward pass's gradients where they are computed, so that they never go through main memory: an
/// optimizer's step. A rasterizer calls the function of its device; the other one throws ShapeError unless overridden.
class GradientConsumer {
 public:
  virtual ~GradientConsumer() = default;

  /// CPU: called once for each block of Gaussians, from several threads at once and in any order; the blocks depend on
  /// the number of Gaussians only, cover all of them and begin at multiples of kGradBlock. `grads` holds dL/d(raw
  /// parameter) of Gaussians [begin, end), row 0 belonging to `begin`; rows of unseen Gaussians are zero, coefficients
  /// of sh above the active degree hold anything. It is valid during the call, the consumer's to overwrite. The
  /// consumer may change Gaussians [begin, end) themselves, no others, and may not move their buffers.
  virtual void ConsumeBlock(int64_t begin, int64_t end, const GaussianRows& grads);

  /// GPU: called once. Queues RunGaussianBackward (render/cuda/gaussian_backward-inl.cuh) with `in`, which computes
  /// each Gaussian's gradient in registers and hands it to the consumer's device code.
  virtual void ConsumeOnDevice(const cuda::GaussianBackwardInput& in);
};

/// Screen-space gradients of adaptive density control [Kerbl 2023].
struct ScreenGradients {
  Buffer<float> sum;    ///< [N] sums of |dL/d(center)|, the center in units of half the image's width and height
  Buffer<float> views;  ///< [N] backward passes in which the Gaussian reached a pixel
};

/// dL/d(camera) of one render. The pose is differentiated where a point of the camera's frame, x = R x_world + t,
/// becomes Exp(rotation) x + translation (Nudged, camera/similarity.h), at zero: the camera turns about its center,
/// then what is before it shifts along its axes. `rotation` is an axis times an angle.
struct CameraGradient {
  Eigen::Vector3d translation;  ///< L per world unit, camera axes
  Eigen::Vector3d rotation;     ///< L per radian, camera axes
  double fx, fy, cx, cy;        ///< L per px
};

/// Milliseconds of the last Forward and Backward by stage, for benchmarks and the trainer's report.
struct RenderTimings {
  double project = 0, bin = 0, blend = 0;  ///< Forward
  double blend_backward = 0;               ///< Backward or BackwardInto
  double gaussian_backward = 0;            ///< Backward or BackwardInto, the consumer's work included
};

/// Amount of work of the last Forward and Backward.
struct RenderStats {
  int64_t visible = 0;               ///< Gaussians that reach at least one tile
  int64_t tile_pairs = 0;            ///< (tile, Gaussian) pairs
  int64_t pixel_pairs = 0;           ///< (pixel, Gaussian) pairs evaluated by the forward blend
  int64_t pixel_pairs_backward = 0;  ///< (pixel, Gaussian) pairs evaluated by the backward blend
  int64_t device_bytes = 0;          ///< memory of a GPU held now, without the images; 0 for a CPU
};

/// Renders Gaussians and differentiates the render. One object serves one thread of work; its buffers grow to the
/// largest use and are then reused. Results have the same bits for any number of CPU threads.
class Rasterizer {
 public:
  virtual ~Rasterizer() = default;

  /// Renders. Throws ShapeError for buffers that do not fit, before any work.
  virtual RenderOutput Forward(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                               RenderPass pass) = 0;

  /// Writes dL/d(raw parameter) of the last Forward(kTrain), with the same `gaussians`, into `grads` (same shapes; rows
  /// of unseen Gaussians are zero). Only coefficients of the active degree of grads.sh are written.
  virtual void Backward(const Gaussians& gaussians, const RenderGrads& upstream, Gaussians* grads) = 0;

  /// Computes the gradients of Backward and hands them to `consumer` instead of writing them.
  virtual void BackwardInto(const Gaussians& gaussians, const RenderGrads& upstream, GradientConsumer* consumer) = 0;

  /// Makes each further backward pass add to these screen gradients of as many Gaussians, on the rasterizer's device;
  /// nullptr ends that. Backward and BackwardInto throw ShapeError where they do not fit.
  virtual void WatchScreen(const ScreenGradients* watched) = 0;

  /// Makes each further backward pass sum the gradient of the camera too, or ends that.
  virtual void WatchCamera(bool watched) = 0;

  /// The camera's gradient in the last backward pass, summed in a fixed order. Throws ShapeError when it was not
  /// watched.
  virtual CameraGradient camera_gradient() const = 0;

  /// Allocates for that many Gaussians now, on a GPU. Throws OutOfMemory.
  virtual void ReserveGaussians(int64_t) {}

  virtual RenderTimings timings() const = 0;
  virtual RenderStats stats() const = 0;
};

/// Makes the rasterizer of a device. Throws UsageError when this build has none for it.
std::unique_ptr<Rasterizer> MakeRasterizer(Device device);

namespace cpu {

/// Makes the one of the CPU.
std::unique_ptr<Rasterizer> MakeCpuRasterizer();

}  // namespace cpu

namespace cuda {  // only in builds with CUDA

/// Makes the one of an NVIDIA GPU. All buffers are on the device, and those given must be. Work goes to the default
/// stream, in order: results may be used at once by other work of that stream. timings(), stats() and
/// camera_gradient() wait for the device. `runs`: as RasterCore's, for tests. Throws UsageError when there is no such
/// device.
std::unique_ptr<Rasterizer> MakeCudaRasterizer(Device device, int runs = 0);

/// Estimate of the device memory that training takes for a view of so many pixels, images included, before it begins.
/// `pairs` of a Gaussian and a tile depend on the scene.
int64_t EstimateRasterizerBytes(int64_t gaussians, int64_t pairs, int64_t pixels);

}  // namespace cuda

}  // namespace oraclegs
