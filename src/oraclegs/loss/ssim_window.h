#pragma once
// Window and constants of SSIM (docs/method.md#ssim) for the kernels of every device.

namespace oraclegs {

inline constexpr int kSsimRadius = 5;  ///< pixels
inline constexpr int kSsimTaps = 2 * kSsimRadius + 1;

/// 0.01^2, 0.03^2: guards against small denominators.
inline constexpr float kSsimC1 = 1e-4f, kSsimC2 = 9e-4f;

/// exp(-i^2 / (2 * 1.5^2)), normalized to sum 1; by distance from the center.
inline constexpr double kSsimWindow[kSsimRadius + 1] = {0.26601172486179436, 0.2130055377112537,   0.10936068950970002,
                                                        0.03600077212843083, 0.007598758135239185, 0.00102838008447911};

/// Effect of pixel weights besides weighing.
enum class MaskMeaning {
  kConfidence,  ///< windows of SSIM see the render everywhere
  kMask,        ///< where the weight is 0 the render is replaced by the target and takes no gradient
};

}  // namespace oraclegs
