#pragma once
// Fused L1 + SSIM, value and gradient in one pass over the rows (docs/method.md#ssim).

#include <memory>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// loss = l1_weight * mean(|render - target| * U) + dssim_weight * mean((1 - SSIM) * U)
struct PhotometricWeights {
  float l1 = 0.8f;
  float dssim = 0.2f;
};

struct PhotometricValue {
  double loss = 0;
  double l1 = 0;     ///< mean(|render - target| * U)
  double dssim = 0;  ///< mean((1 - SSIM) * U)
};

/// Owns the row buffers. The same bits for any number of threads.
class PhotometricLoss {
 public:
  PhotometricLoss();
  ~PhotometricLoss();
  PhotometricLoss(PhotometricLoss&&) noexcept;
  PhotometricLoss& operator=(PhotometricLoss&&) noexcept;

  /// render, target [H,W,3] float32; confidence U [H,W] in [0,1], undefined = 1 everywhere.
  /// grad [H,W,3] receives dL/d(render); undefined = value only. Throws ShapeError.
  PhotometricValue operator()(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& confidence,
                              const PhotometricWeights& weights, Buffer<float>* grad);

 private:
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

/// SSIM map [H,W,3] of two images [H,W,3]; for metrics and tests.
Buffer<float> SsimMap(const Buffer<float>& a, const Buffer<float>& b);

}  // namespace oraclegs
