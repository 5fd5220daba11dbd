#pragma once
// The rasteriser of an NVIDIA GPU. Only in builds with CUDA.

#include <memory>

#include "oraclegs/render/cuda/raster_core.h"
#include "oraclegs/render/image_buffer.h"
#include "oraclegs/render/render.h"

namespace oraclegs::cuda {

/// All tensors lie on the device, as must those given. Work goes to the default stream, in order with libtorch's: what
/// is returned may be used at once, and is there when the device comes to it. timings() and stats() wait for that.
///
/// BackwardBlocks calls its consumer once, with all rows [0, N) and pointers to device memory. Whoever wants to use up
/// gradients without that memory calls BlendBackward, RunGaussianBackward (gaussian_backward-inl.cuh) with what it
/// returns and a consumer of its own, and then EndBackward.
class CudaRasterizer final : public Rasterizer {
 public:
  /// Throws UsageError when there is no such device.
  explicit CudaRasterizer(Device device);

  RenderOutput Forward(const Gaussians& gaussians, const Camera& camera, const RenderOptions& options,
                       RenderPass pass) override;
  void Backward(const Gaussians& gaussians, const RenderGrads& upstream, Gaussians* grads) override;
  void BackwardBlocks(const Gaussians& gaussians, const RenderGrads& upstream, GradConsumer consume) override;

  /// The backward pass up to the gradients of Gaussians on the image plane; valid until the next Forward. Errors as
  /// Backward.
  GaussianBackwardInput BlendBackward(const Gaussians& gaussians, const RenderGrads& upstream);
  void EndBackward() { core_.EndBackward(); }

  /// Room for so many Gaussians, taken now. Throws OutOfMemory.
  void ReserveGaussians(int64_t n) { core_.ReserveGaussians(n); }

  cudaStream_t stream() const { return core_.stream(); }
  /// Device memory that the rasteriser holds, without libtorch's.
  int64_t device_bytes() const { return core_.bytes(); }

  RenderTimings timings() const override;
  RenderStats stats() const override;

 private:
  void RequireHere(const char* who, const char* name, const Buffer<float>& t) const;
  const float* PlaneOrNull(const char* name, const Buffer<float>& t, std::initializer_list<int64_t> shape) const;

  Device device_;
  RasterCore core_;
  ImageBuffer image_, alpha_, inv_depth_;
  Gaussians block_;  // of BackwardBlocks
  int64_t trained_size_ = -1, height_ = 0, width_ = 0;
};

}  // namespace oraclegs::cuda
