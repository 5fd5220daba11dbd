#pragma once
// The one rasteriser interface. Semantics: spec/gaussian_core.md 3 to 6; what runs underneath is the device's affair.

#include <array>
#include <memory>

#include "oraclegs/camera/camera.h"
#include "oraclegs/core/function_ref.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

struct RenderOptions {
  std::array<float, 3> background{0, 0, 0};  ///< RGB, [0, 1]
  int sh_degree = kMaxShDegree;              ///< active degree, 0..3; higher coefficients are neither read nor written
  bool antialiased = false;                  ///< opacity compensation (3.8); a model is rendered as it was trained
  /// [N] float32, finite and >= 0, undefined = 1: multiplies each Gaussian's opacity for this render. 0 leaves the
  /// Gaussian out, without gradient. The product may exceed 1, alpha is capped as ever. Gradients are those of the raw
  /// parameters; the factors get none. Read by Forward only.
  Buffer<float> opacity_factors = {};
};

enum class RenderPass {
  kInference,  ///< nothing is kept
  kTrain,      ///< what Backward needs is kept until the next Forward
};

/// Images of one camera. Valid until the rasteriser's next Forward: buffers are reused.
struct RenderOutput {
  Buffer<float> image;      ///< [H,W,3] composited on the background, not clamped
  Buffer<float> alpha;      ///< [H,W] 1 - transmittance
  Buffer<float> inv_depth;  ///< [H,W] sum of weight / z, not divided by alpha, 1/world unit
};

/// dL/d(output). An undefined tensor means zero.
struct RenderGrads {
  Buffer<float> image;      ///< [H,W,3]
  Buffer<float> alpha;      ///< [H,W]
  Buffer<float> inv_depth;  ///< [H,W]
};

/// Takes the gradients of Gaussians [begin, end); see Rasterizer::BackwardBlocks.
using GradConsumer = FunctionRef<void(int64_t begin, int64_t end, const GaussianRows& grads)>;

/// Blocks of gradients begin at multiples of this many Gaussians. Parameters, moments and gradients of so many are 60
/// KB: they stay in the nearest caches while they are worked on.
inline constexpr int64_t kGradBlock = 64;

/// Milliseconds of the last Forward and Backward by stage, for benchmarks and the trainer's report.
struct RenderTimings {
  double project = 0, bin = 0, blend = 0;  ///< Forward
  double blend_backward = 0;               ///< Backward or BackwardBlocks
  double gaussian_backward = 0;            ///< the same, with what the consumer does
};

/// How much work the last Forward and Backward found.
struct RenderStats {
  int64_t visible = 0;               ///< Gaussians that reach at least one tile
  int64_t tile_pairs = 0;            ///< (tile, Gaussian) pairs
  int64_t pixel_pairs = 0;           ///< (pixel, Gaussian) pairs evaluated by the forward blend
  int64_t pixel_pairs_backward = 0;  ///< by the backward blend
};

/// Renders Gaussians and differentiates the render. One object serves one thread of work; its buffers grow to the
/// largest use and are then reused. Results have the same bits for any number of CPU threads.
class Rasterizer {
 public:
  virtual ~Rasterizer() = default;

  /// Throws ShapeError for tensors that do not fit, before any work.
  virtual RenderOutput Forward(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                               RenderPass pass) = 0;

  /// Writes dL/d(raw parameter) of the last Forward(kTrain), with the same `gaussians`, into `grads` (same shapes; rows
  /// of unseen Gaussians are zero). Of grads.sh only coefficients of the active degree are written.
  virtual void Backward(const Gaussians& gaussians, const RenderGrads& upstream, Gaussians* grads) = 0;

  /// The same, a block of Gaussians at a time, for whoever needs the gradients only once: they never go through main
  /// memory. Calls consume(begin, end, grads) once for each block, from several threads at once and in any order; the
  /// blocks depend on the number of Gaussians only, cover all of them and begin at multiples of kGradBlock.
  /// grads, on the device of the Gaussians, holds the rows of [begin, end), row 0 belonging to `begin`; rows of unseen
  /// Gaussians are zero, coefficients of sh above the active degree hold anything. It is valid during the call, the
  /// consumer's to overwrite. The consumer may change Gaussians [begin, end) themselves, no others, and may not move
  /// their tensors.
  virtual void BackwardBlocks(const Gaussians& gaussians, const RenderGrads& upstream, GradConsumer consume) = 0;

  virtual RenderTimings timings() const = 0;
  virtual RenderStats stats() const = 0;
};

/// The rasteriser of a device. Throws UsageError when this build has none for it.
std::unique_ptr<Rasterizer> MakeRasterizer(Device device);

}  // namespace oraclegs
