#pragma once

namespace oraclegs {

/// Effect of pixel weights besides weighing.
enum class MaskMeaning {
  kConfidence,  ///< windows of SSIM see the render everywhere
  kMask,        ///< where the weight is 0 the render is replaced by the target and takes no gradient
};

}  // namespace oraclegs
