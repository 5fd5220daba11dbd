#include "oraclegs/networks/seva/schedule.h"

#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs::seva {
namespace {

constexpr double kFirstBeta = 5e-6, kLastBeta = 0.012;

}  // namespace

Schedule MakeSchedule(double log_snr_shift) {
  Schedule schedule;
  const double first = std::sqrt(kFirstBeta), last = std::sqrt(kLastBeta), factor = std::exp(log_snr_shift);
  double product = 1;
  for (int64_t i = 0; i < kNoiseLevels; ++i) {
    const double root = first + (last - first) * static_cast<double>(i) / static_cast<double>(kNoiseLevels - 1);
    product *= 1 - root * root;
    schedule.alphas_cumprod.push_back(product);
    schedule.sigmas.push_back(static_cast<float>(std::sqrt((1 - product) / product) * factor));
  }
  return schedule;
}

std::vector<int64_t> StepIndices(int steps) {
  if (steps < 1 || steps > kNoiseLevels) throw ShapeError("StepIndices: {} steps, must be in 1 .. 1000", steps);
  const double top = static_cast<double>(kNoiseLevels - 1), stride = -top / steps;
  std::vector<int64_t> indices;
  for (int i = 0; i < steps; ++i) indices.push_back(static_cast<int64_t>(i * stride + top));
  return indices;
}

std::vector<float> Sigmas(const Schedule& schedule, int steps) {
  std::vector<float> sigmas;
  for (const int64_t index : StepIndices(steps)) sigmas.push_back(schedule.sigmas.at(static_cast<size_t>(index)));
  sigmas.push_back(0);
  return sigmas;
}

Scaling ScalingAt(const Schedule& schedule, float sigma) {
  size_t nearest = 0;
  for (size_t i = 1; i < schedule.sigmas.size(); ++i) {
    if (std::abs(sigma - schedule.sigmas[i]) < std::abs(sigma - schedule.sigmas[nearest])) nearest = i;
  }
  const float level = schedule.sigmas.at(nearest);
  return {static_cast<int64_t>(nearest), level, 1.f, -level, 1.f / std::sqrt(level * level + 1.f)};
}

}  // namespace oraclegs::seva
