#include "oraclegs/core/step_rate.h"

namespace oraclegs {
namespace {

constexpr double kRateWindow = 20;  // seconds

double SecondsBetween(StepRate::Clock::time_point from, StepRate::Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

StepRate::Speed StepRate::Add(const StepDone& step, Clock::time_point now) {
  if (step.stage != stage_) {
    stage_ = step.stage;
    recent_.clear();
  }
  recent_.emplace_back(now, step.done);
  while (recent_.size() > 2 && SecondsBetween(recent_[1].first, now) > kRateWindow) recent_.pop_front();
  const double seconds = SecondsBetween(recent_.front().first, now);
  const auto steps = static_cast<double>(step.done - recent_.front().second);
  if (seconds <= 0 || steps <= 0) return {};
  if (step.total <= 0) return {steps / seconds, 0};
  return {steps / seconds, static_cast<double>(step.total - step.done) * seconds / steps};
}

}  // namespace oraclegs
