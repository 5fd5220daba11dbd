#pragma once
// Where a run stands: how fast its stage goes, which of its stages is at work, and how long all will still take.

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Rate and time left of the stage that reports its progress, measured over the last 20 seconds: the rate falls as
/// Gaussians grow.
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

/// Follows the events of a run that began with RunPlanned; other runs it ignores.
class RunProgress {
 public:
  using Clock = std::chrono::steady_clock;

  struct Place {
    int number = 0;      ///< number of the stage, from 1
    int of = 0;          ///< stages in all
    double seconds = 0;  ///< that it is expected to take; 0 = nobody knows
  };

  void Add(const Event& event, Clock::time_point now = Clock::now());

  /// Nothing for a stage that was not planned.
  std::optional<Place> PlaceOf(const std::string& stage) const;

  /// Seconds left of the whole run; 0 = nobody knows. `stage_left`: seconds that the stage at work still needs by its
  /// own measure, 0 = none yet. The stages to come are expected to be as much slower or faster than planned as those
  /// done were, but for those that had nothing to do or tried again and again.
  double SecondsLeft(double stage_left, Clock::time_point now = Clock::now()) const;

 private:
  struct Row {
    std::string stage;
    double planned = 0;
    std::optional<double> took;  ///< seconds of a finished stage; 0 for one that was kept
  };

  Row* Find(const std::string& stage);
  /// Real by planned seconds of what is finished, drawn to 1 where that is little.
  double Slowness() const;

  std::vector<Row> rows_;
  std::string current_;
  Clock::time_point since_;
};

}  // namespace oraclegs
