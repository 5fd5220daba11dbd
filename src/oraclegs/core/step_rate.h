#pragma once
// How fast a stage goes, from its reports of progress.

#include <chrono>
#include <deque>
#include <string>
#include <utility>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Rate and time left of the stage that reports, measured over the last 20 seconds: the rate falls as Gaussians grow.
class StepRate {
 public:
  using Clock = std::chrono::steady_clock;
  struct Speed {
    double per_second = 0;    ///< 0 = not known yet
    double seconds_left = 0;  ///< 0 = not known
  };

  /// Another stage than that of the last call starts the measurement anew.
  Speed Add(const StepDone& step, Clock::time_point now = Clock::now());
  /// The next call starts anew, whatever its stage.
  void Clear() { stage_.clear(); }
  /// Whose steps are counted; "" = none's.
  const std::string& stage() const { return stage_; }

 private:
  std::string stage_;
  std::deque<std::pair<Clock::time_point, int64_t>> recent_;  ///< steps of the last seconds
};

}  // namespace oraclegs
