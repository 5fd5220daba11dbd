#pragma once
// Fused L1 + SSIM, value and gradient in one pass over the rows (docs/method.md#ssim).

#include <memory>
#include <utility>

#include "oraclegs/core/buffer.h"
#include "oraclegs/loss/ssim_window.h"

namespace oraclegs {

/// loss = l1_weight * mean(|render - target| * U) + dssim_weight * mean((1 - SSIM) * U)
struct PhotometricWeights {
  float l1 = 0.8f;
  float dssim = 0.2f;
};

/// Weight of each pixel of an image: [H,W], 0 or more; undefined = 1 everywhere.
struct PixelWeights {
  // Not explicit: plain weights are a confidence.
  PixelWeights(Buffer<float> values_in = {}, MaskMeaning meaning_in = MaskMeaning::kConfidence)
      : values(std::move(values_in)), meaning(meaning_in) {}

  Buffer<float> values;
  MaskMeaning meaning;

  bool IsMask() const { return meaning == MaskMeaning::kMask && values.defined(); }
};

struct PhotometricValue {
  double loss = 0;
  double l1 = 0;     ///< mean(|render - target| * U)
  double dssim = 0;  ///< mean((1 - SSIM) * U)
};

/// Photometric loss. Its buffers grow to the largest image and are reused. The result does not depend on the number of
/// threads.
class PhotometricLoss {
 public:
  PhotometricLoss();
  ~PhotometricLoss();
  PhotometricLoss(PhotometricLoss&&) noexcept;
  PhotometricLoss& operator=(PhotometricLoss&&) noexcept;

  /// Evaluates the loss. render, target [H,W,3] float32; `pixels` is U. grad [H,W,3] receives dL/d(render); undefined
  /// or null = value only. Means run over all pixels, masked ones included. Throws ShapeError.
  PhotometricValue operator()(const Buffer<float>& render, const Buffer<float>& target, const PixelWeights& pixels,
                              const PhotometricWeights& weights, Buffer<float>* grad);

 private:
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

/// SSIM map [H,W,3] of two images [H,W,3]; for metrics and tests.
Buffer<float> SsimMap(const Buffer<float>& a, const Buffer<float>& b);

}  // namespace oraclegs
