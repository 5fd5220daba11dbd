#pragma once

#include <string>
#include <utility>

#include "oraclegs/core/progress.h"
#include "oraclegs/train/timings.h"

namespace oraclegs {

/// Reports the beginning of a stage, and on Finish its end.
class StageClock {
 public:
  StageClock(std::string stage, const Listener& listener) : stage_(std::move(stage)), listener_(listener) {
    listener_(StageStarted{stage_});
  }

  double Seconds() const { return watch_.Seconds(); }
  /// Returns the seconds since the beginning.
  double Finish() const {
    const double seconds = Seconds();
    Finish(seconds);
    return seconds;
  }
  /// For a stage that has counted its seconds itself.
  void Finish(double seconds) const { listener_(StageFinished{stage_, seconds}); }

 private:
  std::string stage_;
  const Listener& listener_;
  Stopwatch watch_;
};

}  // namespace oraclegs
