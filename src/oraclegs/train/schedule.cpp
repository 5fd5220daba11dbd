#include "oraclegs/train/schedule.h"

#include <algorithm>
#include <cmath>

namespace oraclegs {
namespace {

constexpr double kFirstMeansRate = 1.6e-4;  // per unit of scene extent
constexpr double kLastMeansRate = 1.6e-6;
constexpr double kFirstExposureRate = 1e-2;
constexpr double kLastExposureRate = 1e-3;
constexpr double kLastDepthWeight = 0.01;
constexpr int kHighestShDegree = 3;

double Progress(int64_t iteration, int64_t iterations) {
  return std::clamp(static_cast<double>(iteration) / static_cast<double>(iterations), 0.0, 1.0);
}

/// Log-linear interpolation from `first` at t = 0 to `last` at t = 1.
double LogLinear(double first, double last, double t) {
  return std::exp((1 - t) * std::log(first) + t * std::log(last));
}

/// Density of Beta(2,4) over 20: 0 at t = 0 and 1, largest at t = 1/4.
double Bump(double t) { return t * (1 - t) * (1 - t) * (1 - t); }

}  // namespace

double MeansLearningRate(int64_t iteration, int64_t iterations, double extent) {
  return extent * LogLinear(kFirstMeansRate, kLastMeansRate, Progress(iteration, iterations));
}

double RateFactor(int64_t iteration, int64_t iterations, double last) {
  return LogLinear(1, last, std::max(0.0, 2 * Progress(iteration, iterations) - 1));
}

int ActiveShDegree(int64_t iteration, int64_t interval) {
  return static_cast<int>(std::min<int64_t>(iteration / interval, kHighestShDegree));
}

double ExposureLearningRate(int64_t iteration, int64_t iterations) {
  return LogLinear(kFirstExposureRate, kLastExposureRate, Progress(iteration, iterations));
}

double DepthWeight(int64_t iteration, int64_t iterations) {
  return std::pow(kLastDepthWeight, Progress(iteration, iterations));
}

double SyntheticProbability(int64_t iteration, int64_t iterations, const ProposalSchedule& schedule) {
  const double t = Progress(iteration, iterations);
  const double share = schedule.falls ? std::min(1.0, 2 * (1 - t)) : 1;
  return std::clamp(share * (schedule.floor + schedule.peak * Bump(t)), 0.0, 1.0);
}

}  // namespace oraclegs
