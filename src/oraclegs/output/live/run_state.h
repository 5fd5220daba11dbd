#pragma once
// State of a run for live/state.json: the sum of its events.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/core/run_progress.h"

namespace oraclegs {

enum class RunEnd { kFinished, kFailed, kInterrupted };

/// Current time, as in "2026-11-23T16:00:00Z".
std::string UtcNow();

/// Accumulates the events of a run. docs/formats.md describes the document.
class RunState {
 public:
  RunState() : started_(UtcNow()) {}

  void Add(const Event& event);
  void SetEnd(RunEnd end, const std::string& message);
  bool ended() const { return state_ != "running"; }

  /// Stages, warnings and end. The writer adds times, curves and the splat.
  nlohmann::json ToJson() const;

 private:
  struct StageState {
    std::string name, state = "running";
    double seconds = 0, seconds_left = 0;
    StepDone last = {};
    StepRate::Clock::time_point since = StepRate::Clock::now();
  };

  StageState* Find(const std::string& name);
  StageState& FindOrAdd(const std::string& name);

  std::string started_, state_ = "running", message_;
  std::vector<StageState> stages_;
  std::vector<std::string> warnings_;
  std::vector<RunPlanned::Planned> planned_;
  RunProgress progress_;
  StepRate rate_;
};

}  // namespace oraclegs
