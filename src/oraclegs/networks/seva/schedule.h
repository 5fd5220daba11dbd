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

/// The levels the model was trained on. Many frames show the same thing, so noise must be stronger to hide it: all
/// sigmas are exp(log_snr_shift) times those of Stable Diffusion.
Schedule MakeSchedule(double log_snr_shift = 2.4);

/// Indices of the levels that `steps` (1 .. 1000) steps visit, falling: 999, 979, ... 19 for 50. Throws ShapeError.
std::vector<int64_t> StepIndices(int steps);
/// Their sigmas, with 0 behind them.
std::vector<float> Sigmas(const Schedule& schedule, int steps);

/// How the network's answer F becomes a denoised image: c_out F(c_in x, index) + c_skip x.
struct Scaling {
  int64_t index = 0;  ///< of the nearest level, which takes sigma's place; the network's time
  float sigma = 0;
  float c_skip = 1, c_out = 0, c_in = 0;
};
Scaling ScalingAt(const Schedule& schedule, float sigma);

}  // namespace oraclegs::seva
