#include "oraclegs/networks/seva/sampler.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/networks/seva/vae.h"

namespace oraclegs::seva {
namespace {

constexpr float kExtraSigma = 1e-6f;
constexpr float kTwoPi = 6.2831853071795865f;

/// Scalar of exactly this float32 value: the compiler must not fuse the multiply with the subtraction.
Tensor Scalar(float value) { return torch::full({}, value, torch::kFloat); }

constexpr double kCloseDegrees = 10, kCloseDistance = 1e-5;

/// True when some conditioning frame is near in rotation, some in position, and some in zoom; not necessarily the same
/// one.
bool IsClose(const std::vector<View>& views, const std::vector<bool>& given, size_t frame) {
  const View& view = views[frame];
  bool turned = false, moved = false, zoomed = false;
  for (size_t i = 0; i < views.size(); ++i) {
    if (!given[i]) continue;
    turned |= RotationDegrees(view.world_from_camera.linear(), views[i].world_from_camera.linear()) < kCloseDegrees;
    moved |= (view.center() - views[i].center()).norm() < kCloseDistance;
    zoomed |= view.intrinsics == views[i].intrinsics;
  }
  return turned && moved && zoomed;
}

}  // namespace

Tensor Denoise(const Denoiser& denoiser, const Tensor& x, float sigma) {
  const Scaling scaling = ScalingAt(*denoiser.schedule, sigma);
  const Tensor latents = denoiser.given.slice(1, 0, kLatentChannels);
  const Tensor mask = denoiser.given.slice(1, kLatentChannels, kLatentChannels + 1);
  const Tensor both = at::cat({x, x * (1 - mask) + latents * mask}, 0);
  const Tensor denoised = denoiser.network(both * scaling.c_in, scaling.index)
                              .to(torch::kFloat)
                              .mul_(scaling.c_out)
                              .add_(both, scaling.c_skip);
  const Tensor plain = denoised.slice(0, 0, x.size(0)), conditional = denoised.slice(0, x.size(0));
  return plain + denoiser.weights.view({-1, 1, 1, 1}) * (conditional - plain);
}

float EulerNoiseFactor(float sigma) {
  const Tensor begin = Scalar(sigma), higher = begin + kExtraSigma;
  return at::sqrt(at::clamp_min(higher.square() - begin.square(), 0)).item<float>();
}

Tensor SampleEuler(const Tensor& unit_noise, const EulerProblem& problem) {
  const std::vector<float>& sigmas = problem.sigmas;
  if (sigmas.size() < 2) throw ShapeError("SampleEuler: {} sigmas, at least 2 are needed", sigmas.size());
  Tensor x = unit_noise * std::sqrt(1.f + sigmas.front() * sigmas.front());
  for (size_t i = 0; i + 1 < sigmas.size(); ++i) {
    const auto step = static_cast<int64_t>(i);
    const float factor = EulerNoiseFactor(sigmas[i]), sigma = (Scalar(sigmas[i]) + kExtraSigma).item<float>();
    if (factor > 0) x = x + problem.noise(step) * factor;
    const Tensor slope = (x - problem.denoise(x, sigma)).div_(sigma);
    x = x + slope * (sigmas[i + 1] - sigma);
    if (problem.after_step) problem.after_step(step, x);
  }
  return x;
}

Tensor Noise(const NoiseKey& key, at::IntArrayRef shape) {
  const Tensor out = torch::empty(shape, torch::kFloat);
  const int64_t n = out.numel();
  float* values = out.data_ptr<float>();
  const uint64_t stream = static_cast<uint64_t>(RandomStream::kSeva) | key.draw << 8 | key.step << 48;
  ParallelBlocks(n, 1 << 14, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; i += 4) {
      const Philox r = Philox::Draw(key.seed, stream, static_cast<uint64_t>(i));
      float normal[4];
      for (int pair = 0; pair < 4; pair += 2) {  // Box and Muller
        const float radius = std::sqrt(-2 * std::log(OpenUniform(r.x[pair])));
        const float angle = kTwoPi * OpenUniform(r.x[pair + 1]);
        normal[pair] = radius * std::cos(angle);
        normal[pair + 1] = radius * std::sin(angle);
      }
      for (int64_t j = i; j < std::min(i + 4, end); ++j) values[j] = normal[j - i];
    }
  });
  return out;
}

Tensor GuidanceWeights(const std::vector<View>& views, const std::vector<bool>& given, double cfg) {
  if (views.size() != given.size() || std::find(given.begin(), given.end(), true) == given.end()) {
    throw ShapeError("GuidanceWeights: {} views and {} marks, of which one at least must be true", views.size(),
                     given.size());
  }
  std::vector<double> weights(views.size(), cfg);
  for (size_t i = 0; i < weights.size(); ++i) {
    if (IsClose(views, given, i)) weights[i] = kGuidanceBesideAnImage;
  }
  return torch::tensor(weights, torch::kDouble).to(torch::kFloat);
}

}  // namespace oraclegs::seva
