#pragma once
// Sampler: from noise to latents in steps of Euler's method (docs/method.md#seva-sampler), with a
// weight of classifier-free guidance for each frame (#seva-guidance).

#include <cstdint>
#include <functional>
#include <vector>

#include "oraclegs/networks/common/tensor.h"
#include "oraclegs/networks/seva/cameras.h"
#include "oraclegs/networks/seva/schedule.h"

namespace oraclegs::seva {

/// Network on both halves of guidance: scaled latents [2T, 4, h, w], the T unconditional ones first, and the index of
/// the noise level -> [2T, 4, h, w] float32.
using Network = std::function<Tensor(const Tensor& scaled, int64_t index)>;

struct Denoiser {
  Network network;
  const Schedule* schedule = nullptr;
  Tensor given;    ///< [T, 5, h, w]: latents of conditioning frames and 1 in channel 4, 0 for all other frames
  Tensor weights;  ///< guidance weights, [T]
};

/// x [T, 4, h, w] float32 denoised, with guidance. Conditioning frames enter as their clean latents.
Tensor Denoise(const Denoiser& denoiser, const Tensor& x, float sigma);

/// Euler steps down the sigmas; the last sigma is 0.
struct EulerProblem {
  std::vector<float> sigmas;
  std::function<Tensor(const Tensor& x, float sigma)> denoise = {};
  /// Standard normal numbers, shaped like x, for step i.
  std::function<Tensor(int64_t step)> noise = {};
  /// Called after every step, with x; may be empty, and may throw to stop.
  std::function<void(int64_t step, const Tensor& x)> after_step = {};
};
/// unit_noise: standard normal, [T, 4, h, w] float32. The result has that shape.
Tensor SampleEuler(const Tensor& unit_noise, const EulerProblem& problem);

/// Factor of the noise added at the start of a step, which begins with a millionth more noise than its sigma says.
/// Computed in float32 as the model's authors do, where it vanishes for large sigmas.
float EulerNoiseFactor(float sigma);

/// Identifies one use of a seed.
struct NoiseKey {
  uint64_t seed = 0;
  uint64_t draw = 0;  ///< numbers candidates, passes and chunks
  uint64_t step = 0;  ///< 0 for the start, 1 + i for step i
};
/// Standard normal float32 numbers that do not depend on the number of threads.
Tensor Noise(const NoiseKey& key, at::IntArrayRef shape);

/// Strength of guidance for conditioning frames and frames at the place of one, where guidance has little to add; the
/// value of SEVA's authors.
inline constexpr double kGuidanceBesideAnImage = 1.2;

/// Weights [T] float32: kGuidanceBesideAnImage for those frames, `cfg` for the others. Throws ShapeError unless `given`
/// (which frames condition) has one entry a view and a true one.
Tensor GuidanceWeights(const std::vector<View>& views, const std::vector<bool>& given, double cfg);

}  // namespace oraclegs::seva
