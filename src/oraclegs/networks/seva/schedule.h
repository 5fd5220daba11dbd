#pragma once
// The noise levels of SEVA's diffusion (docs/method.md#seva-noise-schedule).

#include <cstdint>
#include <vector>

namespace oraclegs::seva {

inline constexpr int64_t kNoiseLevels = 1000;

struct Schedule {
  std::vector<double> alphas_cumprod;  ///< 1000, falling
  std::vector<float> sigmas;           ///< 1000, rising
};

/// Levels that the model was trained on: all sigmas are exp(log_snr_shift) times those of Stable Diffusion. Many frames
/// show one thing, so noise must be stronger to hide it.
Schedule MakeSchedule(double log_snr_shift = 2.4);

/// Indices of the levels that `steps` (1 .. 1000) steps visit, falling: 999, 979, ... 19 for 50 steps. Throws
/// ShapeError.
std::vector<int64_t> StepIndices(int steps);
/// Sigmas of those levels, followed by 0.
std::vector<float> Sigmas(const Schedule& schedule, int steps);

/// Factors that turn the network's answer F into a denoised image: c_out F(c_in x, index) + c_skip x.
struct Scaling {
  int64_t index = 0;  ///< index of the nearest level, which replaces sigma; the network's time
  float sigma = 0;
  float c_skip = 1, c_out = 0, c_in = 0;
};
Scaling ScalingAt(const Schedule& schedule, float sigma);

}  // namespace oraclegs::seva
