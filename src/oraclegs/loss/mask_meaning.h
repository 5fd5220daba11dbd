#pragma once

namespace oraclegs {

/// What the weights of pixels do besides weighing them.
enum class MaskMeaning {
  kConfidence,  ///< windows of SSIM see the render everywhere
  kMask,        ///< where the weight is 0 the render is replaced by the target and takes no gradient
};

}  // namespace oraclegs
